// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/capi/internal/failure.h"

#include <atomic>
#include <cstdint>
#include <string>

namespace earshot::capi {

/// Tells a caller's callback, and throws Cancelled once it asks to stop.
class CallbackProgress : public Progress {
public:
    CallbackProgress(es_progress_callback callback, void* user_data) noexcept
        : callback_(callback), user_data_(user_data) {}

    void report(std::string_view stage, std::size_t done, std::size_t total) override {
        if (!is_cancelled_.load(std::memory_order_relaxed) && callback_ != nullptr &&
            callback_(user_data_, std::string(stage).c_str(), done, total) != 0) {
            is_cancelled_.store(true, std::memory_order_relaxed);
        }
        if (is_cancelled_.load(std::memory_order_relaxed)) {
            throw Cancelled();
        }
    }

private:
    es_progress_callback callback_;
    void* user_data_;
    std::atomic<bool> is_cancelled_{false};
};

/// Throws Failure for numbers that are no number of threads.
void require_threads(std::int32_t threads, const char* argument);

}  // namespace earshot::capi
