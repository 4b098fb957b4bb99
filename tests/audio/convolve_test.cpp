// SPDX-License-Identifier: MIT
#include "earshot/audio/convolve.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace earshot::audio {
namespace {

std::vector<double> noise(std::uint64_t seed, std::size_t size) {
    std::vector<double> samples;
    for (std::uint64_t n = 0; n < size; ++n) {
        samples.push_back(random(seed, 0, n) - 0.5);
    }
    return samples;
}

std::vector<double> convolve_by_definition(const std::vector<double>& a,
                                           const std::vector<double>& b) {
    std::vector<double> sum(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = 0; k < b.size(); ++k) {
            sum[i + k] += a[i] * b[k];
        }
    }
    return sum;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
        ASSERT_NEAR(found[n], expected[n], 1e-12) << n;
    }
}

TEST(Convolve, IsTheSumOfProducts) {
    for (const auto& [signal, filter] : {std::pair<std::size_t, std::size_t>{1, 1},
                                         {1, 5000},
                                         {5000, 1},
                                         {3000, 700},
                                         {4096, 4097}}) {
        const auto a = noise(1, signal);
        const auto b = noise(2, filter);
        expect_near(convolve(a, b), convolve_by_definition(a, b));
        expect_near(convolve_directly(a, b), convolve_by_definition(a, b));
    }
    EXPECT_TRUE(convolve({}, noise(1, 3)).empty());
    EXPECT_TRUE(convolve(noise(1, 3), {}).empty());
}

TEST(PartitionedConvolver, GivesTheConvolutionBlockByBlock) {
    constexpr std::size_t kBlock = 64;
    const auto signal = noise(3, 10 * kBlock);
    for (const std::size_t length : {1U, 63U, 64U, 65U, 200U}) {
        const auto filter = noise(4, length);
        PartitionedConvolver convolver(filter, kBlock);
        std::vector<double> found(signal.size());
        for (std::size_t begin = 0; begin < signal.size(); begin += kBlock) {
            convolver.process(std::span(signal).subspan(begin, kBlock),
                              std::span(found).subspan(begin, kBlock));
        }
        auto expected = convolve_by_definition(signal, filter);
        expected.resize(signal.size());
        expect_near(found, expected);
    }
}

TEST(ConvolveMoving, WithEqualFiltersIsAPlainConvolution) {
    const auto signal = noise(5, 3001);
    const auto filter = noise(6, 100);
    for (const std::size_t count : {1U, 2U, 7U}) {
        const std::vector<std::vector<double>> filters(count, filter);
        expect_near(convolve_moving(signal, filters), convolve(signal, filter));
    }
}

TEST(ConvolveMoving, FadesFromOneFilterToTheNext) {
    const std::vector<double> ones(1000, 1.0);
    const std::vector<std::vector<double>> filters = {{1.0}, {3.0}};
    Executor two(2);
    const auto found = convolve_moving(ones, filters, two);
    ASSERT_EQ(found.size(), 1000U);
    EXPECT_NEAR(found[0], 1.0, 1e-12);
    EXPECT_NEAR(found[249], 1.0, 1e-12);
    EXPECT_NEAR(found[500], 2.0, 1e-12);
    EXPECT_NEAR(found[751], 3.0, 1e-12);
    EXPECT_NEAR(found[999], 3.0, 1e-12);
    for (std::size_t n = 1; n < found.size(); ++n) {
        EXPECT_LE(std::abs(found[n] - found[n - 1]), 0.0041);
    }
}

TEST(ConvolveMoving, HasEachFilterAtItsPlace) {
    const std::vector<double> ones(1000, 1.0);
    const std::vector<std::vector<double>> filters = {{1.0}, {3.0}, {2.0}};
    const std::vector<double> places = {-100.0, 300.0, 700.0};
    const auto found = convolve_moving(ones, filters, places);
    ASSERT_EQ(found.size(), 1000U);
    EXPECT_NEAR(found[0], 1.5, 1e-12);
    EXPECT_NEAR(found[100], 2.0, 1e-12);
    EXPECT_NEAR(found[300], 3.0, 1e-12);
    EXPECT_NEAR(found[500], 2.5, 1e-12);
    EXPECT_NEAR(found[700], 2.0, 1e-12);
    EXPECT_NEAR(found[999], 2.0, 1e-12);
}

}  // namespace
}  // namespace earshot::audio
