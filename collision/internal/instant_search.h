// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"
#include "earshot/collision/statistics.h"

#include <vector>

namespace earshot::collision {

// The queries of discrete.h, with the work that they took.

struct InstantContacts {
    std::vector<TrianglePair> pairs;
    WorldStatistics statistics;
};

/// find_contacts().
InstantContacts search_contacts(const Body& a, const Body& b, Executor& executor);

/// find_self_contacts().
InstantContacts search_self_contacts(const Body& body, Executor& executor);

struct InstantDistance {
    MeshDistance distance;
    WorldStatistics statistics;
};

/// distance().
InstantDistance search_distance(const Body& a, const Body& b);

}  // namespace earshot::collision
