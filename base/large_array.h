// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace earshot {

/// Memory on a cache line's border; large blocks on large pages where the system grants them, which
/// spares random reads most of their misses in the page tables. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);
void free_large(void* block) noexcept;

/// Asks for large pages for the inside of memory that was allocated otherwise and that nobody has
/// touched yet. Contents stay as they are.
void ask_for_large_pages(void* memory, std::size_t bytes) noexcept;

template <typename T>
struct LargeAllocator {
    using value_type = T;

    LargeAllocator() = default;
    template <typename U>
    explicit LargeAllocator(const LargeAllocator<U>&) noexcept {}

    T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / sizeof(T)) {
            throw std::bad_array_new_length();
        }
        return static_cast<T*>(allocate_large(count * sizeof(T)));
    }
    void deallocate(T* block, std::size_t) noexcept { free_large(block); }

    /// resize() leaves new elements of trivial types unset, for threads to fill.
    template <typename U>
    void construct(U* place) {
        ::new (static_cast<void*>(place)) U;
    }
    template <typename U, typename... Args>
    void construct(U* place, Args&&... args) {
        ::new (static_cast<void*>(place)) U(std::forward<Args>(args)...);
    }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

/// A vector for millions of elements that are read in random order.
template <typename T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace earshot
