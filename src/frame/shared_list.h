#pragma once

#include <cassert>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace kadr {

/// A list whose beginning it shares with others, unchangeable, followed by entries of its own. Copies of it, and lists
/// that begin alike, hold the beginning once.
template <class T>
class SharedList {
public:
    using value_type = T;
    using Shared = std::shared_ptr<const std::vector<T>>;

    SharedList() = default;
    SharedList(Shared shared, std::vector<T> own) : shared_(std::move(shared)), own_(std::move(own)) {}

    std::size_t size() const { return shared_size() + own_.size(); }
    bool empty() const { return size() == 0; }
    const T& operator[](std::size_t i) const { return i < shared_size() ? (*shared_)[i] : own_[i - shared_size()]; }
    const T& front() const { return (*this)[0]; }
    const T& back() const { return (*this)[size() - 1]; }
    /// @throws std::out_of_range
    const T& at(std::size_t i) const { return i < shared_size() ? (*shared_)[i] : own_.at(i - shared_size()); }

    const Shared& shared() const { return shared_; }  ///< null: nothing is shared
    std::size_t shared_size() const { return shared_ ? shared_->size() : 0; }
    const std::vector<T>& own() const { return own_; }
    /// An entry of its own, to change. @pre i >= shared_size()
    T& edit(std::size_t i) {
        assert(i >= shared_size());
        return own_[i - shared_size()];
    }
    /// @pre the last entry is its own
    T& edit_back() { return own_.back(); }
    void push_back(T value) { own_.push_back(std::move(value)); }

    class const_iterator {
    public:
        using iterator_category = std::forward_iterator_tag;
        using value_type = T;
        using difference_type = std::ptrdiff_t;
        using pointer = const T*;
        using reference = const T&;
        const_iterator() = default;
        const_iterator(const SharedList* list, std::size_t at) : list_(list), at_(at) {}
        reference operator*() const { return (*list_)[at_]; }
        pointer operator->() const { return &(*list_)[at_]; }
        const_iterator& operator++() { return ++at_, *this; }
        const_iterator operator++(int) { return {list_, at_++}; }
        bool operator==(const const_iterator&) const = default;

    private:
        const SharedList* list_ = nullptr;
        std::size_t at_ = 0;
    };
    const_iterator begin() const { return {this, 0}; }
    const_iterator end() const { return {this, size()}; }

private:
    Shared shared_;
    std::vector<T> own_;
};

}  // namespace kadr
