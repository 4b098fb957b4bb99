// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace bench {

/// Answers of one kind for every pose.
struct DiscreteAnswers {
    std::vector<bool> intersects;
    std::vector<double> distances;
    std::vector<std::vector<earshot::collision::TrianglePair>> contacts;  // ascending
};

/// A library that asks two meshes, of which the second moves.
class DiscreteContender {
public:
    virtual ~DiscreteContender() = default;

    virtual void build(const earshot::geometry::MeshView& a,
                       const earshot::geometry::MeshView& b) = 0;
    /// The meshes deform: their trees are refitted. Precondition: build() with their triangles.
    virtual void refit(const earshot::geometry::MeshView& a,
                       const earshot::geometry::MeshView& b) = 0;
    virtual bool intersects(const earshot::collision::Pose& pose) = 0;
    virtual double distance(const earshot::collision::Pose& pose) = 0;
    /// All pairs of triangles that intersect, in any order, and where.
    virtual std::vector<earshot::collision::TrianglePair> contacts(
        const earshot::collision::Pose& pose) = 0;
};

/// FCL with boxes of its fastest kind; null where it is not there.
std::unique_ptr<DiscreteContender> fcl_contender();

/// The same of Coal, which grew out of FCL.
std::unique_ptr<DiscreteContender> coal_contender();

}  // namespace bench
