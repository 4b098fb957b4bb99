// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/aabb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string>

namespace earshot::bvh {

inline bool same_bits(const Tree& a, const Tree& b) {
    return a.nodes().size() == b.nodes().size() &&
           std::memcmp(a.nodes().data(), b.nodes().data(), a.nodes().size_bytes()) == 0 &&
           std::equal(a.primitives().begin(),
                      a.primitives().end(),
                      b.primitives().begin(),
                      b.primitives().end());
}

/// With 2 and 8 threads and with every instruction set the tree is the one of one thread.
inline void expect_the_same_tree_everywhere(std::span<const geometry::Aabb> boxes,
                                            const BuildOptions& options) {
    const Tree expected = Tree::build(boxes, options);
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        EXPECT_TRUE(same_bits(Tree::build(boxes, options, executor), expected)) << threads;
    }
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        const Tree tree = Tree::build(boxes, options);
        override_simd_target("auto");
        EXPECT_TRUE(same_bits(tree, expected)) << target;
    }
}

}  // namespace earshot::bvh
