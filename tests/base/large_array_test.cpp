// SPDX-License-Identifier: MIT
#include "earshot/base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

namespace earshot {
namespace {

TEST(LargeArray, KeepsWhatIsWrittenWhateverItsSize) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{1000}, std::size_t{3'000'001}}) {
        LargeArray<std::uint32_t> array(count);
        ASSERT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0U);
        std::iota(array.begin(), array.end(), 7U);
        array.resize(count + 1, 5U);
        EXPECT_EQ(array.front(), 7U);
        EXPECT_EQ(array[count - 1], static_cast<std::uint32_t>(count) + 6U);
        EXPECT_EQ(array.back(), 5U);
    }
}

TEST(AskForLargePages, LeavesContentsAlone) {
    std::vector<std::uint32_t> numbers(2'000'000);
    std::iota(numbers.begin(), numbers.end(), 0U);
    const std::vector<std::uint32_t> copy = numbers;
    ask_for_large_pages(numbers.data(), numbers.size() * sizeof(numbers[0]));
    EXPECT_EQ(numbers, copy);
    ask_for_large_pages(nullptr, 0);
}

}  // namespace
}  // namespace earshot
