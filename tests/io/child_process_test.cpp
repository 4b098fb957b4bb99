// SPDX-License-Identifier: MIT
#include "earshot/io/internal/child_process.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <new>
#include <stdexcept>
#include <thread>
#include <unistd.h>
#include <vector>

namespace earshot::io {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(ChildProcess, HandsBackWhatItsWorkGives) {
    const ChildResult result = run_in_child({}, [](const ByteSink& sink) {
        for (int i = 0; i < 100; ++i) {
            sink(std::string(100000, static_cast<char>('a' + i % 26)));
        }
        sink("end");
    });
    EXPECT_EQ(result.end, ChildEnd::finished);
    ASSERT_EQ(result.output.size(), 10000003U);
    EXPECT_EQ(result.output[100000], 'b');
    EXPECT_EQ(result.output.substr(10000000), "end");
}

TEST(ChildProcess, LeavesTheParentsMemoryAlone) {
    int number = 1;
    const ChildResult result = run_in_child({}, [&](const ByteSink& sink) {
        number = 2;
        sink(std::to_string(number));
    });
    EXPECT_EQ(result.output, "2");
    EXPECT_EQ(number, 1);
}

TEST(ChildProcess, TellsHowItsWorkFailed) {
    EXPECT_EQ(run_in_child({}, [](const ByteSink&) { throw std::runtime_error("no"); }).end,
              ChildEnd::failed);
    EXPECT_EQ(run_in_child({}, [](const ByteSink&) { throw std::bad_alloc(); }).end,
              ChildEnd::memory);
    const ChildResult killed = run_in_child({}, [](const ByteSink& sink) {
        sink("before");
        std::signal(SIGTERM, SIG_DFL);
        std::raise(SIGTERM);
    });
    EXPECT_EQ(killed.end, ChildEnd::crashed);
    EXPECT_EQ(killed.output, "before");
}

TEST(ChildProcess, EndsWhatTakesTooLong) {
    const auto start = std::chrono::steady_clock::now();
    const ChildResult slept = run_in_child({.time = 0.2}, [](const ByteSink&) {
        std::this_thread::sleep_for(std::chrono::minutes(5));
    });
    EXPECT_EQ(slept.end, ChildEnd::time);
    const ChildResult busy = run_in_child({.processor_time = 1.0}, [](const ByteSink&) {
        for (std::atomic<unsigned> count = 0;; ++count) {
        }
    });
    EXPECT_EQ(busy.end, ChildEnd::time);
    EXPECT_LT(seconds_since(start), 25.0);
}

TEST(ChildProcess, EndsWhatClosesItsPipeAndStays) {
    const ChildResult result = run_in_child({.time = 0.3}, [](const ByteSink&) {
        for (int descriptor = 3; descriptor < 64; ++descriptor) {
            ::close(descriptor);
        }
        std::this_thread::sleep_for(std::chrono::minutes(5));
    });
    EXPECT_EQ(result.end, ChildEnd::time);
}

TEST(ChildProcess, LimitsOutput) {
    EXPECT_EQ(
        run_in_child({.output = 1000}, [](const ByteSink& sink) { sink(std::string(1001, 'x')); })
            .end,
        ChildEnd::output);
    EXPECT_EQ(
        run_in_child({.output = 1000}, [](const ByteSink& sink) { sink(std::string(1000, 'x')); })
            .end,
        ChildEnd::finished);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildProcess, LimitsMemory) {
    const auto take = [](const ByteSink& sink) {
        const std::vector<char> bytes(std::size_t{200} << 20U, 'x');
        sink({bytes.data(), 10});
    };
    EXPECT_EQ(run_in_child({.memory = std::size_t{100} << 20U}, take).end, ChildEnd::memory);
    EXPECT_EQ(run_in_child({.memory = std::size_t{300} << 20U}, take).end, ChildEnd::finished);
}
#endif

// Threads that allocate and start children of their own at the same time.
TEST(ChildProcess, RunsBesideOtherThreads) {
    std::atomic<int> finished = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&] {
            for (int repeat = 0; repeat < 10; ++repeat) {
                const ChildResult result = run_in_child({}, [](const ByteSink& sink) {
                    std::vector<std::string> texts(100, std::string(1000, 'x'));
                    sink(texts.back());
                });
                finished +=
                    result.end == ChildEnd::finished && result.output.size() == 1000 ? 1 : 0;
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(finished, 40);
}

}  // namespace
}  // namespace earshot::io
