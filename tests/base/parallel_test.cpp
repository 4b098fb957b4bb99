// SPDX-License-Identifier: MIT
#include "earshot/base/parallel.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace earshot {
namespace {

using Chunks = std::set<std::pair<std::size_t, std::size_t>>;

Chunks chunks_of(Executor& executor, std::size_t count, std::size_t grain) {
    Chunks chunks;
    std::mutex mutex;
    executor.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
        const std::lock_guard lock(mutex);
        chunks.emplace(begin, end);
    });
    return chunks;
}

TEST(Executor, MakesTheSameChunksOnAnyNumberOfThreads) {
    const Chunks want = {{0, 4}, {4, 8}, {8, 10}};
    for (const int threads : {0, 1, 2, 3, 8}) {
        Executor executor(threads);
        EXPECT_EQ(chunks_of(executor, 10, 4), want) << threads;
        EXPECT_EQ(chunks_of(executor, 4, 4), (Chunks{{0, 4}})) << threads;
        EXPECT_EQ(chunks_of(executor, 1, 100), (Chunks{{0, 1}})) << threads;
        EXPECT_TRUE(chunks_of(executor, 0, 4).empty()) << threads;
    }
    EXPECT_EQ(chunk_count(10, 4), want.size());
    EXPECT_EQ(chunk_count(0, 4), 0U);
}

TEST(Executor, VisitsEveryItemOnce) {
    Executor executor(4);
    std::vector<std::atomic<int>> visits(10007);
    executor.for_each(visits.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ++visits[i];
        }
    });
    for (const std::atomic<int>& count : visits) {
        ASSERT_EQ(count.load(), 1);
    }
}

TEST(Executor, UsesTheThreadsAskedForThoughAnEarlierOneAskedForFewer) {
    // Four chunks that wait for each other need four threads, whatever the number of cores.
    const Executor earlier(2);
    Executor executor(4);
    std::atomic<int> arrived{0};
    executor.for_each(4, 1, [&](std::size_t, std::size_t) {
        ++arrived;
        const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (arrived < 4 && std::chrono::steady_clock::now() < patience) {
            std::this_thread::yield();
        }
        EXPECT_EQ(arrived.load(), 4);
    });
}

TEST(Executor, TakesFarMoreThreadsThanThereAreCores) {
    Executor executor(100000);
    EXPECT_EQ(chunks_of(executor, 10, 4).size(), 3U);
}

TEST(Executor, RethrowsTheLowestChunksExceptionOfSeveral) {
    for (const int threads : {1, 2, 8}) {
        Executor executor(threads);
        for (int repetition = 0; repetition < 20; ++repetition) {
            std::string message;
            try {
                executor.for_each(100, 1, [](std::size_t begin, std::size_t) {
                    if (begin >= 37) {
                        throw std::runtime_error(std::to_string(begin));
                    }
                });
            } catch (const std::runtime_error& failure) {
                message = failure.what();
            }
            ASSERT_EQ(message, "37") << threads << " threads";
        }
    }
}

// What is cancelled ends soon: once a chunk has thrown, those behind it are left out.
TEST(Executor, LeavesOutChunksBehindOneThatHasThrown) {
    for (const int threads : {1, 2, 8}) {
        Executor executor(threads);
        std::atomic<bool> has_thrown{false};
        std::atomic<std::size_t> begun_afterwards{0};
        const auto body = [&](std::size_t begin, std::size_t) {
            if (begin == 0) {
                has_thrown = true;
                throw std::runtime_error("no");
            }
            while (!has_thrown) {
                std::this_thread::yield();
            }
            std::this_thread::sleep_for(std::chrono::microseconds(20));
            ++begun_afterwards;
        };
        EXPECT_THROW(executor.for_each(100000, 1, body), std::runtime_error);
        // All of them would take more than a second on these threads.
        EXPECT_LT(begun_afterwards, 50000U) << threads << " threads";
    }
}

TEST(Executor, CanBeUsedFromWithinItsOwnLoops) {
    for (const int threads : {1, 2, 4}) {
        Executor executor(threads);
        std::vector<std::size_t> sums(50, 0);
        executor.for_each(sums.size(), 1, [&](std::size_t outer, std::size_t) {
            std::vector<std::size_t> parts(chunk_count(100, 7));
            executor.for_each(100, 7, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    parts[begin / 7] += i * outer;
                }
            });
            for (const std::size_t part : parts) {
                sums[outer] += part;
            }
        });
        for (std::size_t outer = 0; outer < sums.size(); ++outer) {
            ASSERT_EQ(sums[outer], 4950 * outer) << threads;
        }
    }
}

TEST(Executor, WorksAgainAfterAnException) {
    Executor executor(2);
    const auto fail = [](std::size_t, std::size_t) { throw std::runtime_error("no"); };
    EXPECT_THROW(executor.for_each(10, 1, fail), std::runtime_error);
    EXPECT_EQ(chunks_of(executor, 10, 4).size(), 3U);
}

TEST(Executor, RunsOnTheCallingThreadIfSerial) {
    EXPECT_EQ(Executor::serial().threads(), 1);
    const std::thread::id caller = std::this_thread::get_id();
    std::vector<std::size_t> begins;
    Executor::serial().for_each(10, 3, [&](std::size_t begin, std::size_t) {
        begins.push_back(begin);  // in order
        EXPECT_EQ(std::this_thread::get_id(), caller);
    });
    EXPECT_EQ(begins, (std::vector<std::size_t>{0, 3, 6, 9}));
}

TEST(Executor, CountsTheCoresWhenAskedForAllThreads) {
    EXPECT_GE(Executor(0).threads(), 1);
    EXPECT_EQ(Executor(3).threads(), 3);
}

TEST(Executor, RefusesANegativeNumberOfThreads) {
    try {
        const Executor executor(-2);
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), "threads");
        EXPECT_NE(std::string(error.what()).find("-2"), std::string::npos);
    }
}

}  // namespace
}  // namespace earshot
