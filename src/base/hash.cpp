#include "base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <bit>
#include <fstream>
#include <memory>
#include <vector>

#include "base/error.h"

namespace kadr {

namespace {

struct FreeState {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};
using State = std::unique_ptr<XXH3_state_t, FreeState>;

State make_state() {
    State state(XXH3_createState());
    if (!state) throw std::bad_alloc();
    XXH3_128bits_reset(state.get());
    return state;
}

Hash digest(const XXH3_state_t* state) {
    const XXH128_hash_t value = XXH3_128bits_digest(state);
    return {value.low64, value.high64};
}

/// The same bytes on machines of either byte order.
std::array<unsigned char, 8> little_endian(std::uint64_t value) {
    std::array<unsigned char, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(value >> (8 * i));
    return bytes;
}

void add_word(XXH3_state_t* state, std::uint64_t value) {
    const auto bytes = little_endian(value);
    XXH3_128bits_update(state, bytes.data(), bytes.size());
}

XXH3_state_t* state_of(void* state) { return static_cast<XXH3_state_t*>(state); }

}  // namespace

std::string Hash::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

Hasher::Hasher() : state_(make_state().release()) {}
Hasher::~Hasher() { XXH3_freeState(state_of(state_)); }

void Hasher::add(std::string_view bytes) {
    add_word(state_of(state_), bytes.size());
    XXH3_128bits_update(state_of(state_), bytes.data(), bytes.size());
}

void Hasher::add(double value) { add(std::bit_cast<std::int64_t>(value == 0 ? 0.0 : value)); }

void Hasher::add(std::int64_t value) {
    add_word(state_of(state_), sizeof value);
    add_word(state_of(state_), static_cast<std::uint64_t>(value));
}

Hash Hasher::finish() const { return digest(state_of(state_)); }

Hash hash_file(const std::filesystem::path& path) {
    const State state = make_state();
    std::ifstream file(path, std::ios::binary);
    std::vector<char> block(1u << 20);
    while (file) {
        file.read(block.data(), static_cast<std::streamsize>(block.size()));
        XXH3_128bits_update(state.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    }
    // At the end of the file `read` sets eof and fail together; anything else is a file that cannot be read.
    if (!file.eof()) throw InputError(fmt::format("cannot read '{}'", path.string()), "expected a readable file");
    return digest(state.get());
}

}  // namespace kadr
