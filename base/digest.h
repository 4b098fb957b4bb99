// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot {

/// 64-bit digest (FNV-1a) of results, for tests and benchmarks that compare bits, and of names, for
/// numbers that follow from them. Not cryptographic.
class Digest {
public:
    void add_bytes(std::span<const std::byte> bytes) noexcept;

    /// Adds the object representation; T must have no padding.
    template <typename T>
    void add(const T& value) noexcept {
        add_bytes(std::as_bytes(std::span<const T, 1>(&value, 1)));
    }

    std::uint64_t value() const noexcept { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace earshot
