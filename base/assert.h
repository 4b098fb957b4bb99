// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cassert>

/// A precondition the caller must keep: checked in builds without NDEBUG (dev, asan, tsan), free in
/// release. Not for bad input: that throws earshot::Error.
#define EARSHOT_ASSERT(condition) assert(condition)
