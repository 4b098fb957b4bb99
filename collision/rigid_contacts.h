// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/rigid_motion.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace earshot::collision {

/// A mesh and its rigid motion. The arrays of the view outlive the query.
struct MovingBody {
    geometry::MeshView mesh;
    RigidMotion motion{};
};

struct RigidContactOptions {
    /// Bodies this close along every axis are in contact, metres.
    double min_separation = 0.0;
    /// How much farther apart along an axis a contact may be, metres, > 0. The smaller, the more
    /// steps.
    double tolerance = 1e-3;
    /// Which pairs of bodies (a < b) are tested; empty: all of which at least one moves.
    std::function<bool(std::uint32_t a, std::uint32_t b)> filter{};
};

/// The first contact of bodies that move rigidly, or none; toi is within the whole motion. Motions
/// are split into equal linear steps of World, whose chords deviate by a fraction of the tolerance,
/// and the separation is widened by it: no contact is missed, and none is late. Bodies that
/// intersect at the beginning are in contact at 0, by two faces of them. The same for any executor.
///
/// Throws Error if the tolerance is not positive, the separation is negative, or more than 2^24
/// steps were needed, and what World::update() and find_contacts() throw. Preconditions: those of
/// MeshView and Screw.
std::optional<Contact> first_contact(std::span<const MovingBody> bodies,
                                     const RigidContactOptions& options = {},
                                     Executor& executor = Executor::serial());

}  // namespace earshot::collision
