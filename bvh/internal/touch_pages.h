// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/base/parallel.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace earshot::bvh {

/// A vector of default elements. The system clears new memory when it is touched first, which takes
/// longer than setting the elements; all threads share that.
template <typename T>
std::vector<T> vector_on_touched_pages(std::size_t count, Executor& executor) {
    constexpr std::size_t kPage = 4096;
    constexpr std::size_t kGrain = std::size_t{1} << 21;  // a large page
    std::vector<T> result;
    result.reserve(count);
    auto* const memory = reinterpret_cast<std::byte*>(result.data());
    ask_for_large_pages(memory, count * sizeof(T));
    if (executor.threads() > 1) {
        executor.for_each(count * sizeof(T), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t at = begin; at < end; at += kPage) {
                memory[at] = std::byte{0};
            }
        });
    }
    result.resize(count);
    return result;
}

}  // namespace earshot::bvh
