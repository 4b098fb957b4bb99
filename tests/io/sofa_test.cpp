// SPDX-License-Identifier: MIT
#include "earshot/io/sofa.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>
#include <mysofa.h>

#include "support/temporary_folder.h"
#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

namespace earshot::io {
namespace {

// Where Debian's libmysofa1 installs it.
const std::filesystem::path kKemar = "/usr/share/libmysofa/MIT_KEMAR_normal_pinna.sofa";

class Kemar : public ::testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kKemar)) {
            GTEST_SKIP() << kKemar << " is not installed";
        }
        head = read_hrir_set(kKemar);
    }
    audio::HrirSet head;
};

double energy(const std::vector<double>& samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample * sample;
    }
    return sum;
}

// By how many samples the second signal follows the first: where their correlation is largest.
double lag(const std::vector<double>& first, const std::vector<double>& second) {
    double largest = 0.0;
    std::size_t best = 0;
    for (std::size_t shift = 0; shift < 100; ++shift) {
        double sum = 0.0;
        for (std::size_t n = 0; n + shift < second.size(); ++n) {
            sum += first[n] * second[n + shift];
        }
        if (sum > largest) {
            largest = sum;
            best = shift;
        }
    }
    return static_cast<double>(best);
}

// Gardner and Martin 1995: 710 directions, 44.1 kHz.
TEST_F(Kemar, IsReadAsPublished) {
    EXPECT_EQ(head.directions.size(), 710U);
    EXPECT_EQ(head.sample_rate, 44100.0);
}

// libmysofa has a reader of its own, in single precision.
TEST_F(Kemar, IsReadAsLibmysofaReadsIt) {
    int fault = MYSOFA_OK;
    MYSOFA_HRTF* sofa = mysofa_load(kKemar.c_str(), &fault);
    ASSERT_NE(sofa, nullptr);
    mysofa_tocartesian(sofa);
    ASSERT_EQ(sofa->M, head.directions.size());
    for (std::size_t m = 0; m < head.directions.size(); ++m) {
        const audio::Hrir& hrir = head.directions[m];
        EXPECT_NEAR(hrir.distance, 1.4, 1e-12);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            ASSERT_NEAR(hrir.towards[axis] * hrir.distance,
                        sofa->SourcePosition.values[3 * m + axis],
                        1e-6);
        }
        const float* samples = sofa->DataIR.values + 2 * m * sofa->N;
        ASSERT_TRUE(std::equal(hrir.left.begin(), hrir.left.end(), samples));
        ASSERT_TRUE(std::equal(hrir.right.begin(), hrir.right.end(), samples + sofa->N));
    }
    mysofa_free(sofa);
}

TEST_F(Kemar, HearsASourceFirstAndLoudestInTheNearerEar) {
    const auto& left = head.directions[closest_direction(head, {0.0, 1.0, 0.0})];
    EXPECT_GT(left.towards[1], 0.99);
    EXPECT_GT(energy(left.left), 4.0 * energy(left.right));
    // A rigid sphere of 8.75 cm radius: from (pi / 2 + 1) a / c = 0.66 ms at high frequencies
    // (Woodworth 1938) to 3 a / c = 0.77 ms at low ones (Kuhn 1977); a head is no sphere: 15 %.
    const double late = lag(left.left, left.right) / head.sample_rate;
    EXPECT_GT(late, 0.85 * 0.66e-3);
    EXPECT_LT(late, 1.15 * 0.77e-3);
}

// A free field: an arrival of pressure 1 after a whole number of samples is the head response.
TEST_F(Kemar, IsWhatASourceInAFreeFieldSoundsLike) {
    const audio::Assembler assembler(audio::Bands::octaves(), head.sample_rate);
    const audio::HrirInterpolator interpolator(head);
    const audio::Orientation facing_y{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    for (std::size_t i = 0; i < 24; ++i) {
        const auto& measured = head.directions[i * head.directions.size() / 24];
        const auto [x, y, z] = measured.towards;
        audio::Arrival arrival;
        arrival.delay = 441 / 44100.0;
        arrival.pressure.fill(1.0);
        arrival.direction = {y, -x, -z};  // from front x, left y as seen by who faces y
        const auto ears = render_binaural(assembler, {&arrival, 1}, interpolator, facing_y);
        for (std::size_t n = 0; n < measured.left.size(); ++n) {
            ASSERT_NEAR(ears[0].samples[441 + n], measured.left[n], 1e-9) << i << " " << n;
            ASSERT_NEAR(ears[1].samples[441 + n], measured.right[n], 1e-9) << i << " " << n;
        }
    }
}

// The transfer function at a frequency does not depend on the sample rate.
TEST_F(Kemar, KeepsItsSpectrumAtAnotherSampleRate) {
    const auto at_48k = audio::resampled({head.sample_rate, {head.directions[100]}}, 48000.0);
    const auto transform = [](const std::vector<double>& samples, double turn) {
        std::complex<double> sum = 0.0;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            sum += samples[n] * std::polar(1.0, -turn * static_cast<double>(n));
        }
        return sum;
    };
    const double scale = std::sqrt(energy(head.directions[100].left));
    for (const double hz : {300.0, 1000.0, 4000.0, 12000.0}) {
        const auto before =
            transform(head.directions[100].left, 2 * std::numbers::pi * hz / 44100.0);
        const auto after =
            transform(at_48k.directions[0].left, 2 * std::numbers::pi * hz / 48000.0);
        EXPECT_NEAR(std::abs(after - before) / scale, 0.0, 0.01) << hz;
    }
}

TEST(Sofa, RefusesWhatIsNone) {
    const test::TemporaryFolder folder;
    const auto file = folder.file("no.sofa", "no HDF5 at all");
    EXPECT_THROW(read_hrir_set(file), Error);
    std::filesystem::remove(file);
    EXPECT_THROW(read_hrir_set(file), Error);
}

}  // namespace
}  // namespace earshot::io
