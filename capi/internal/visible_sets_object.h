// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/visibility/visible_sets.h"

#include <utility>

namespace earshot::capi {

/// Never changes.
struct VisibleSetsObject : ObjectOf<ES_KIND_VISIBLE_SETS> {
    explicit VisibleSetsObject(visibility::VisibleSets the_sets) : sets(std::move(the_sets)) {}
    visibility::VisibleSets sets;
};

}  // namespace earshot::capi
