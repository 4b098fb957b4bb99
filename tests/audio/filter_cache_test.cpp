// SPDX-License-Identifier: MIT
#include "earshot/audio/filter_cache.h"

#include "earshot/audio/internal/band_gain_kernel.h"
#include "earshot/audio/internal/filter_cache_state.h"
#include "earshot/audio/late_noise.h"
#include "earshot/audio/response_metrics.h"
#include "earshot/base/parallel.h"
#include "earshot/base/random.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace earshot::audio {
namespace {

/// An object that is as large as its key says.
class Block {
public:
    explicit Block(std::size_t key) : key_(key) { ++made; }
    std::size_t key() const { return key_; }
    std::size_t bytes() const { return key_; }

    static int made;

private:
    std::size_t key_;
};
int Block::made = 0;

TEST(RecentlyUsed, KeepsWhatFits) {
    Block::made = 0;
    RecentlyUsed<Block> cache(100);
    EXPECT_EQ(cache.borrow(std::size_t{40})->key(), 40U);
    EXPECT_EQ(cache.borrow(std::size_t{50})->key(), 50U);
    EXPECT_EQ(cache.borrow(std::size_t{40})->key(), 40U);
    EXPECT_EQ(Block::made, 2);
    EXPECT_EQ(cache.borrow(std::size_t{30})->key(), 30U);  // 50 was used before 40
    EXPECT_EQ(cache.size(), 2U);
    cache.borrow(std::size_t{40});
    EXPECT_EQ(Block::made, 3);
    cache.borrow(std::size_t{50});
    EXPECT_EQ(Block::made, 4);
}

TEST(RecentlyUsed, KeepsWhatIsOnLoan) {
    Block::made = 0;
    RecentlyUsed<Block> cache(100);
    {
        const auto first = cache.borrow(std::size_t{90});
        const auto second = cache.borrow(std::size_t{80});
        EXPECT_EQ(cache.size(), 2U);
        EXPECT_EQ(first->key(), 90U);
        EXPECT_EQ(&*first, &*cache.borrow(std::size_t{90}));
    }
    cache.borrow(std::size_t{5});
    EXPECT_EQ(cache.size(), 2U);
    EXPECT_EQ(Block::made, 3);
}

TEST(RecentlyUsed, KeepsOneThatIsTooLarge) {
    Block::made = 0;
    RecentlyUsed<Block> cache(100);
    cache.borrow(std::size_t{500});
    cache.borrow(std::size_t{500});
    EXPECT_EQ(Block::made, 1);
}

TEST(WorkspacePool, GivesWhatCameBack) {
    WorkspacePool<std::vector<int>> pool;
    pool.with([](std::vector<int>& memory) { memory.assign(3, 7); });
    {
        const auto kept = pool.borrow();
        EXPECT_EQ(*kept, std::vector<int>(3, 7));
        EXPECT_TRUE(pool.borrow()->empty());  // the kept one is on loan
    }
}

TEST(BandFilters, HaveTheGainsOfTheFormulaToTheBit) {
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        for (const Bands* bands : {&Bands::octaves(), &Bands::third_octaves()}) {
            const double rate = 44100.0;
            const FilterKey key(*bands, rate, 1280);
            const BandFilters filters(key);
            EXPECT_EQ(filters.rows(), bands->count() - 1);
            for (std::size_t band = 0; band < filters.rows(); ++band) {
                const auto gains = filters.gains(band);
                for (std::size_t k = 0; k < gains.size(); ++k) {
                    const double hz = rate * static_cast<double>(k) / 1280.0;
                    ASSERT_EQ(gains[k], std::sqrt(band_power_gain(*bands, band, hz)))
                        << target << " band " << band << " bin " << k;
                }
            }
        }
    }
    override_simd_target("auto");
}

TEST(ComplementaryFilters, SumToOne) {
    const ComplementaryFilters filters(FilterKey(Bands::octaves(), 48000.0, 1024));
    ASSERT_EQ(filters.rows(), 10U);
    for (std::size_t k = 1; k < 513; ++k) {
        double sum = 0.0;
        for (std::size_t band = 0; band < filters.rows(); ++band) {
            sum += filters.gains(band)[k];
        }
        EXPECT_NEAR(sum, 1.0, 1e-14) << k;
    }
}

/// Noise that decays, of different lengths.
ImpulseResponse response_of(std::size_t index) {
    ImpulseResponse response;
    response.samples.resize(9000 + 3000 * index);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        response.samples[n] =
            random_between(1, index, n, -1.0, 1.0) / (1.0 + static_cast<double>(n));
    }
    return response;
}

EnergyHistogram histogram_of(std::size_t index) {
    EnergyHistogram histogram;
    histogram.reflection_growth = 1e5;
    histogram.energy.resize(100 + 70 * index);
    for (Spectrum& energy : histogram.energy) {
        energy.fill(1e-4);
    }
    return histogram;
}

// What is kept, and what other threads did, leaves no trace in the results.
TEST(FilterCache, ChangesNoBit) {
    constexpr std::size_t kCount = 12;
    const Bands& bands = Bands::octaves();
    std::vector<std::vector<double>> noise(kCount);
    std::vector<std::optional<double>> level_db(kCount);
    const FilterCache cache;
    Executor executor(3);
    executor.for_each(kCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            noise[i] = late_noise(bands, histogram_of(i % 4), 48000.0, i, cache);
            level_db[i] =
                response_metrics(bands, response_of(i % 4), {}, cache).bands[5].strength_db;
        }
    });
    for (std::size_t i = 0; i < kCount; ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(noise[i], late_noise(bands, histogram_of(i % 4), 48000.0, i));
        EXPECT_EQ(level_db[i], response_metrics(bands, response_of(i % 4)).bands[5].strength_db);
    }
}

}  // namespace
}  // namespace earshot::audio
