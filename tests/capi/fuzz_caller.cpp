// SPDX-License-Identifier: MIT
#include "capi/fuzz_caller.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace earshot::capi_fuzz {

std::uint64_t Caller::some(es_kind kind) {
    std::vector<std::uint64_t> right;
    std::copy_if(live_.begin(), live_.end(), std::back_inserter(right), [&](std::uint64_t handle) {
        return es_kind_of(handle) == kind;
    });
    return right.empty() ? 0
                         : right[static_cast<std::size_t>(below(static_cast<int>(right.size())))];
}

std::uint64_t Caller::handle(es_kind kind) {
    const std::uint64_t right = some(kind);
    if (right != 0 && !chance(0.08)) {
        return right;
    }
    wrong = true;
    switch (below(5)) {
        case 0:
            return 0;
        case 1: {  // of another kind
            const auto other = static_cast<es_kind>(1 + below(9));
            const std::uint64_t found = some(other);
            return other == kind ? 0 : found;
        }
        case 2:  // a stale one
            return released_.empty() ? 0
                                     : released_[static_cast<std::size_t>(
                                           below(static_cast<int>(released_.size())))];
        case 3: {  // one with a bit that is wrong, unless it is the handle of another object
            const std::uint64_t flipped = right ^ std::uint64_t{1}
                                                      << static_cast<unsigned>(below(64));
            return es_kind_of(flipped) == kind ? 0 : flipped;
        }
        default:
            return static_cast<std::uint64_t>(dice_.between(0.0, 1e19));
    }
}

std::uint64_t Caller::take() {
    if (live_.empty()) {
        return 0;
    }
    const auto i = static_cast<std::size_t>(below(static_cast<int>(live_.size())));
    const std::uint64_t handle = live_[i];
    live_.erase(live_.begin() + static_cast<std::ptrdiff_t>(i));
    constexpr std::size_t kMaxReleased = 100;
    if (released_.size() == kMaxReleased) {
        released_.erase(released_.begin());
    }
    released_.push_back(handle);
    return handle;
}

std::int32_t Caller::choice(int count) {
    if (chance(0.02)) {
        wrong = true;
        constexpr std::array<std::int32_t, 4> kWrong = {-1,
                                                        std::numeric_limits<std::int32_t>::min(),
                                                        std::numeric_limits<std::int32_t>::max(),
                                                        1000};
        return kWrong[static_cast<std::size_t>(below(4))];
    }
    return below(count);
}

double Caller::bad_number(double low, double high) {
    wrong = true;
    const std::array<double, 5> numbers = {std::numeric_limits<double>::quiet_NaN(),
                                           std::numeric_limits<double>::infinity(),
                                           -std::numeric_limits<double>::infinity(),
                                           low - 1.0 - std::abs(low),
                                           high + 1.0 + std::abs(high)};
    return numbers[static_cast<std::size_t>(below(5))];
}

double Caller::number(double low, double high, std::array<double, 2> good) {
    return chance(0.02) ? bad_number(low, high) : dice_.between(good[0], good[1]);
}

std::size_t Caller::index(std::size_t count) {
    if (count == 0 || chance(0.03)) {
        wrong = true;
        return chance(0.5)
                   ? count
                   : std::numeric_limits<std::size_t>::max() - static_cast<std::size_t>(below(3));
    }
    return static_cast<std::size_t>(below(static_cast<int>(count)));
}

const double* Caller::values(
    std::size_t count, double low, double high, bool null_is_right, double limit) {
    if (count > 0 && chance(0.01)) {
        wrong = wrong || !null_is_right;
        return nullptr;
    }
    std::vector<double>& buffer = buffers_.emplace_back(count);
    for (double& value : buffer) {
        // Whole numbers make coplanar, parallel and touching things.
        value = chance(0.3) ? std::round(dice_.between(low, high)) : dice_.between(low, high);
    }
    if (count > 0 && chance(0.02)) {
        buffer[static_cast<std::size_t>(below(static_cast<int>(count)))] =
            bad_number(-limit, limit);
    }
    return buffer.data();
}

const double* Caller::distances(std::size_t count) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<double>& buffer = buffers_.emplace_back(count);
    for (double& value : buffer) {
        value = chance(0.1) ? kInfinity : dice_.between(0.0, 10.0);
        if (chance(0.005)) {
            wrong = true;
            value = chance(0.5) ? -1.0 : std::numeric_limits<double>::quiet_NaN();
        }
    }
    return buffer.data();
}

const std::uint32_t* Caller::indices(std::size_t count, std::size_t limit, bool null_is_right) {
    if (count > 0 && chance(0.01)) {
        wrong = wrong || !null_is_right;
        return nullptr;
    }
    std::vector<std::uint32_t>& buffer = numbers_.emplace_back(count);
    for (std::uint32_t& value : buffer) {
        value = limit == 0 ? 0 : static_cast<std::uint32_t>(below(static_cast<int>(limit)));
    }
    wrong = wrong || (count > 0 && limit == 0);
    if (count > 0 && chance(0.02)) {
        wrong = true;
        buffer[static_cast<std::size_t>(below(static_cast<int>(count)))] =
            static_cast<std::uint32_t>(chance(0.5) ? limit : 0xFFFFFFFFU);
    }
    return buffer.data();
}

const char* Caller::text(const std::vector<std::string>& names, bool null_is_right) {
    if (chance(0.02)) {
        wrong = wrong || !null_is_right;
        return nullptr;
    }
    if (chance(0.02)) {
        wrong = true;
        return "caf\xe9";
    }
    return texts_
        .emplace_back(names[static_cast<std::size_t>(below(static_cast<int>(names.size())))])
        .c_str();
}

double* Caller::room(std::size_t count, bool null_is_right) {
    if (chance(0.02)) {
        wrong = wrong || (!null_is_right && count > 0);
        return nullptr;
    }
    return buffers_.emplace_back(count).data();
}

std::uint8_t* Caller::bytes(std::size_t count) {
    bytes_.clear();
    if (chance(0.02)) {
        wrong = wrong || count > 0;
        return nullptr;
    }
    return bytes_.emplace_back(count).data();
}

std::uint32_t* Caller::numbers(std::size_t count, bool null_is_right) {
    if (chance(0.02)) {
        wrong = wrong || (!null_is_right && count > 0);
        return nullptr;
    }
    return numbers_.emplace_back(count).data();
}

}  // namespace earshot::capi_fuzz
