// SPDX-License-Identifier: MIT
#include "earshot/base/large_array.h"

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

void free_large(void* block) noexcept {
    std::free(block);
}

}  // namespace earshot
