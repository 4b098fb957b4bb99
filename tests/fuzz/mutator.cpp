// SPDX-License-Identifier: MIT
#include "fuzz/mutator.h"

#include "earshot/base/random.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>
#include <utility>

namespace earshot::test {
namespace {

constexpr std::uint64_t kSeed = 20;

/// Numbers in the ranges that one mutation needs, one after another.
class Draws {
public:
    explicit Draws(std::uint64_t mutation) : stream_(kSeed, mutation) {}

    /// Below `end`, which is not 0.
    std::size_t below(std::size_t end) {
        return static_cast<std::size_t>(stream_.bits(index_++) % end);
    }
    std::uint64_t bits() { return stream_.bits(index_++); }

    template <typename T>
    const T& one_of(std::span<const T> choices) {
        return choices[below(choices.size())];
    }

private:
    RandomStream stream_;
    std::uint64_t index_ = 0;
};

/// A stretch of bytes that is not empty, short ones more often.
std::pair<std::size_t, std::size_t> stretch(const std::string& bytes, Draws& draws) {
    const std::size_t begin = draws.below(bytes.size());
    const std::size_t left = bytes.size() - begin;
    const std::size_t longest = std::min(left, std::size_t{1} << draws.below(16));
    return {begin, 1 + draws.below(longest)};
}

void flip_bit(std::string& bytes, Draws& draws) {
    char& byte = bytes[draws.below(bytes.size())];
    byte = static_cast<char>(byte ^ (1 << draws.below(8)));
}

void change_byte(std::string& bytes, Draws& draws) {
    bytes[draws.below(bytes.size())] = static_cast<char>(draws.bits() & 0xFFU);
}

/// A binary integer at the borders of its type, in either byte order.
void change_integer(std::string& bytes, Draws& draws) {
    constexpr std::array<std::uint64_t, 12> kValues{0,
                                                    1,
                                                    0x7F,
                                                    0xFF,
                                                    0x7FFF,
                                                    0xFFFF,
                                                    0x1000000,
                                                    0x7FFFFFFF,
                                                    0x80000000,
                                                    0xFFFFFFFF,
                                                    0x7FFFFFFFFFFFFFFF,
                                                    0xFFFFFFFFFFFFFFFF};
    const std::size_t size = std::min(bytes.size(), std::size_t{2} << draws.below(3));
    const std::size_t at = draws.below(bytes.size() - size + 1);
    const std::uint64_t value = draws.one_of(std::span<const std::uint64_t>(kValues));
    const bool is_big_endian = draws.below(4) == 0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t place = is_big_endian ? size - 1 - i : i;
        bytes[at + place] = static_cast<char>(value >> 8 * i & 0xFFU);
    }
}

/// Another number in place of a decimal one; nothing if there is none after a random place.
void change_number(std::string& bytes, Draws& draws) {
    constexpr std::array<std::string_view, 18> kNumbers{"0",
                                                        "1",
                                                        "-1",
                                                        "2",
                                                        "3",
                                                        "-0",
                                                        "0.5",
                                                        "1e-320",
                                                        "1e308",
                                                        "1e999",
                                                        "nan",
                                                        "255",
                                                        "65536",
                                                        "16777217",
                                                        "2147483648",
                                                        "4294967295",
                                                        "9223372036854775807",
                                                        "99999999999999999999"};
    constexpr std::string_view kDigits = "0123456789";
    const std::size_t begin = bytes.find_first_of(kDigits, draws.below(bytes.size()));
    if (begin != std::string::npos) {
        const std::size_t end = bytes.find_first_not_of("0123456789.eE-+", begin);
        bytes.replace(begin,
                      std::min(end, bytes.size()) - begin,
                      draws.one_of(std::span<const std::string_view>(kNumbers)));
    }
}

void erase_stretch(std::string& bytes, Draws& draws) {
    const auto [begin, size] = stretch(bytes, draws);
    bytes.erase(begin, size);
}

void repeat_stretch(std::string& bytes, Draws& draws) {
    const auto [begin, size] = stretch(bytes, draws);
    const std::string copy = bytes.substr(begin, size);
    const std::size_t times = size < 64 ? 1 + draws.below(8) : 1;
    for (std::size_t i = 0; i < times; ++i) {
        bytes.insert(begin, copy);
    }
}

void move_stretch(std::string& bytes, Draws& draws) {
    const auto [begin, size] = stretch(bytes, draws);
    const std::string copy = bytes.substr(begin, size);
    bytes.erase(begin, size);
    bytes.insert(draws.below(bytes.size() + 1), copy);
}

void truncate(std::string& bytes, Draws& draws) {
    bytes.resize(draws.below(bytes.size()));
}

/// Inserts a token or puts it over what is there.
void put_token(std::string& bytes, std::span<const std::string> tokens, Draws& draws) {
    if (tokens.empty()) {
        return;
    }
    const std::string& token = draws.one_of(tokens);
    const std::size_t at = draws.below(bytes.size() + 1);
    const std::size_t over = draws.below(2) == 0 ? 0 : std::min(token.size(), bytes.size() - at);
    bytes.replace(at, over, token);
}

/// A stretch of another seed, inserted or from there to the end.
void splice(std::string& bytes, std::span<const std::string> seeds, Draws& draws) {
    const std::string& other = draws.one_of(seeds);
    if (other.empty()) {
        return;
    }
    const std::size_t at = draws.below(bytes.size() + 1);
    if (draws.below(2) == 0) {
        bytes.resize(at);
        bytes += other.substr(draws.below(other.size()));
    } else {
        const auto [begin, size] = stretch(other, draws);
        bytes.insert(at, other, begin, size);
    }
}

}  // namespace

Mutator::Mutator(std::vector<std::string> seeds, std::vector<std::string> tokens)
    : seeds_(std::move(seeds)), tokens_(std::move(tokens)) {}

std::string Mutator::mutated(std::uint64_t number) const {
    using Change = void (*)(std::string&, Draws&);
    constexpr std::array<Change, 8> kChanges{flip_bit,
                                             change_byte,
                                             change_integer,
                                             change_number,
                                             erase_stretch,
                                             repeat_stretch,
                                             move_stretch,
                                             truncate};
    Draws draws(number);
    std::string bytes = seeds_[static_cast<std::size_t>(number % seeds_.size())];
    // Half of the mutations are one change: many changes leave little that a reader accepts.
    const std::size_t count = std::size_t{1} << draws.below(1 + draws.below(4));
    for (std::size_t i = 0; i < count; ++i) {
        // Truncation leaves little to mutate, so that it comes last in the list and seldom.
        const std::size_t kind = draws.below(20);
        if (bytes.empty() || kind < 3) {
            put_token(bytes, tokens_, draws);
        } else if (kind < 5) {
            splice(bytes, seeds_, draws);
        } else {
            kChanges[kind == 19 ? kChanges.size() - 1 : (kind - 5) / 2](bytes, draws);
        }
    }
    return bytes;
}

}  // namespace earshot::test
