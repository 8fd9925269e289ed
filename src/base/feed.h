#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/hash.h"

namespace kadr {

/// Feeds values of many types to a hasher; the order of calls is the format of what is hashed.
///
/// @tparam Types  a class that derives from it, says `using Feed<Types>::add;` and has an `add` for each type of its own,
///                which takes a value apart: (*this)(value.x, value.y);
template <class Types>
class Feed {
public:
    explicit Feed(Hasher& hasher) : hasher_(hasher) {}

    template <class... Values>
    void operator()(const Values&... values) {
        (types().add(values), ...);
    }

    template <class Number>
    requires std::integral<Number> || std::is_enum_v<Number>
    void add(Number value) { hasher_.add(static_cast<std::int64_t>(value)); }
    void add(std::floating_point auto value) { hasher_.add(static_cast<double>(value)); }
    void add(const std::string& text) { hasher_.add(text); }
    template <class T>
    void add(const std::optional<T>& value) {
        add(value.has_value());
        if (value) types().add(*value);
    }
    template <class... Ts>
    void add(const std::variant<Ts...>& value) {
        add(value.index());
        std::visit([this](const auto& inside) { types().add(inside); }, value);
    }
    template <class T>
    void add(const std::vector<T>& list) {
        add(list.size());
        for (const T& item : list) types().add(item);
    }

protected:
    /// An array of plain data as it lies in memory. It must have no padding.
    template <class T>
    void add_bytes(const T* first, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        hasher_.add(std::string_view(reinterpret_cast<const char*>(first), count * sizeof(T)));
    }

private:
    Types& types() { return static_cast<Types&>(*this); }

    Hasher& hasher_;
};

}  // namespace kadr
