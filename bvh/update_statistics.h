// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/update_policy.h"

#include <cstdint>

namespace earshot::bvh {

/// How often hierarchies that were there before were refitted, repaired and rebuilt to follow their
/// primitives.
struct UpdateStatistics {
    std::uint64_t refits = 0, repairs = 0, rebuilds = 0;

    UpdateStatistics& operator+=(const UpdateStatistics& other) noexcept;
    void count(UpdateAction action) noexcept;

    friend bool operator==(const UpdateStatistics&, const UpdateStatistics&) = default;
};

}  // namespace earshot::bvh
