// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_pages.h"

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace earshot {

/// Gives memory on a cache line's border, in large pages if it is large: random reads then miss
/// less often in the page tables. Elements of trivial types begin unset, for threads to fill.
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
        void* block = ::operator new(count * sizeof(T), kLine);
        ask_for_large_pages(block, count * sizeof(T));
        return static_cast<T*>(block);
    }
    void deallocate(T* block, std::size_t) noexcept { ::operator delete(block, kLine); }

    template <typename U>
    void construct(U* place) {
        ::new (static_cast<void*>(place)) U;
    }
    template <typename U, typename... Args>
    void construct(U* place, Args&&... args) {
        ::new (static_cast<void*>(place)) U(std::forward<Args>(args)...);
    }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }

private:
    static constexpr std::align_val_t kLine{64};
};

/// A vector for millions of elements that are read in random order.
template <typename T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace earshot
