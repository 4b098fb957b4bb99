// SPDX-License-Identifier: MIT
#include "earshot/base/large_array.h"

#include <cstdint>
#include <cstdlib>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace earshot {
namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kLargePage = std::size_t{1} << 21;

std::size_t round_up_to(std::size_t bytes, std::size_t unit) {
    return (bytes + unit - 1) / unit * unit;
}

}  // namespace

void* allocate_large(std::size_t bytes) {
    const std::size_t unit = bytes >= kLargePage ? kLargePage : kCacheLine;
    if (bytes > static_cast<std::size_t>(-1) - unit) {
        throw std::bad_alloc();
    }
    const std::size_t rounded = round_up_to(bytes, unit);
    void* block = std::aligned_alloc(unit, rounded);
    if (block == nullptr) {
        throw std::bad_alloc();
    }
#ifdef __linux__
    if (unit == kLargePage) {
        madvise(block, rounded, MADV_HUGEPAGE);  // a wish: without it all is right, but slower
    }
#endif
    return block;
}

void ask_for_large_pages([[maybe_unused]] void* memory,
                         [[maybe_unused]] std::size_t bytes) noexcept {
#ifdef __linux__
    // Only whole large pages; the ends may share theirs with something else.
    const auto begin = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t first = (begin + kLargePage - 1) / kLargePage * kLargePage;
    const std::uintptr_t last = (begin + bytes) / kLargePage * kLargePage;
    if (first < last) {
        // A wish, as above.
        madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    }
#endif
}

void free_large(void* block) noexcept {
    std::free(block);
}

}  // namespace earshot
