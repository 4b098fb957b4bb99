// SPDX-License-Identifier: MIT
#pragma once

#include "earshot.h"
#include "support/dice.h"
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

namespace earshot::capi_fuzz {

/// Makes up arguments of calls. Most are right, so that calls go deep; `wrong` tells whether one of
/// the call under way is surely not, so that the call must fail.
class Caller {
public:
    explicit Caller(std::uint64_t seed) : dice_(seed) {}

    // Of the call under way.
    bool wrong = false;
    void begin() {
        wrong = false;
        buffers_.clear();
        numbers_.clear();
        texts_.clear();
    }

    bool chance(double probability) { return dice_.chance(probability); }
    int below(int count) { return dice_.below(count); }

    // Handles.
    std::uint64_t handle(es_kind kind);
    /// A new object, which is released some time.
    void keep(std::uint64_t handle) { live_.push_back(handle); }
    /// One of the live ones is taken out; 0 if there are none.
    std::uint64_t take();
    std::size_t live_count() const noexcept { return live_.size(); }
    /// A right handle of that kind, or 0.
    std::uint64_t some(es_kind kind);

    // Numbers. A wrong one is outside of the range, or no number.
    std::int32_t choice(int count);
    std::int32_t flag() { return choice(2); }
    std::int32_t threads() { return chance(0.05) ? bad_threads() : 1; }
    /// In `good`, or outside of the range.
    double number(double low, double high, std::array<double, 2> good);
    double number(double low, double high) { return number(low, high, {low, high}); }
    std::size_t index(std::size_t count);
    std::size_t count(int max) { return static_cast<std::size_t>(dice_.below(max + 1)); }

    // Arrays, valid until begin(). `count` elements of them are read.
    const double* points(std::size_t count, double size = 4.0, bool null_is_right = false) {
        return values(3 * count, -size, size, null_is_right);
    }
    const double* values(std::size_t count,
                         double low,
                         double high,
                         bool null_is_right = false,
                         double limit = 1e13);
    /// Vectors of any finite length.
    const double* vectors(std::size_t count) { return values(3 * count, -1.0, 1.0, false, 1e308); }
    /// Infinite now and then; a negative one is wrong, or what is no number.
    const double* distances(std::size_t count);
    const std::uint32_t* indices(std::size_t count, std::size_t limit, bool null_is_right = false);
    /// A name, or now and then one that is none.
    const char* text(const std::vector<std::string>& names, bool null_is_right = false);

    /// Room to write to, or null, which is wrong.
    template <typename T>
    T* out(T& target) {
        if (chance(0.02)) {
            wrong = true;
            return nullptr;
        }
        return &target;
    }
    double* room(std::size_t count, bool null_is_right);
    std::uint8_t* bytes(std::size_t count);
    std::uint32_t* numbers(std::size_t count, bool null_is_right);

private:
    std::int32_t bad_threads() {
        wrong = true;
        return chance(0.5) ? -dice_.below(1000) - 1 : 1025 + dice_.below(1000000);
    }
    double bad_number(double low, double high);

    support::Dice dice_;
    std::vector<std::uint64_t> live_, released_;
    std::vector<std::vector<double>> buffers_;
    std::vector<std::vector<std::uint32_t>> numbers_;
    std::vector<std::vector<std::uint8_t>> bytes_;
    std::deque<std::string> texts_;  // which stay where they are
};

/// Options of simulations that take a millisecond.
es_simulation_options simulation_options_of(Caller& c);

/// Keeps a handle that a call has made.
inline es_status kept(Caller& c, es_status status, const std::uint64_t& handle) {
    if (status == ES_OK) {
        c.keep(handle);
    }
    return status;
}

/// What is given is not left out by the optimiser.
inline void keep_reading(double value) {
    static volatile double kept_value = 0.0;
    kept_value = value;
    static_cast<void>(kept_value);
}

/// Sums what a view shows, so that the sanitizer sees it read.
template <typename T>
double sum(const T* values, std::size_t count) {
    double total = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        total += static_cast<double>(values[i]);
    }
    return total;
}

/// Makes one call of a kind and returns its status; `wrong` says whether it had to fail.
using Call = es_status (*)(Caller&);

/// All calls, and their weights: how often they are made.
struct WeightedCall {
    const char* name;
    Call call;
    int weight = 10;
};
const std::vector<WeightedCall>& scene_calls();
const std::vector<WeightedCall>& simulation_calls();
const std::vector<WeightedCall>& model_calls();
const std::vector<WeightedCall>& query_calls();
const std::vector<WeightedCall>& location_calls();
const std::vector<WeightedCall>& engine_calls();

}  // namespace earshot::capi_fuzz
