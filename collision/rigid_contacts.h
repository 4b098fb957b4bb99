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

/// A mesh and how it moves. Its arrays stay where they are while it is asked about.
struct MovingBody {
    geometry::MeshView mesh;
    RigidMotion motion{};
};

struct RigidContactOptions {
    /// Bodies that come as near as this along every axis are in contact, metres.
    double min_separation = 0.0;
    /// How many metres more a contact may be apart along an axis; > 0. The fewer, the more steps.
    double tolerance = 1e-3;
    /// Which pairs of bodies (a < b) are looked at; empty: all of which one moves.
    std::function<bool(std::uint32_t a, std::uint32_t b)> filter{};
};

/// The first contact of bodies that move rigidly, or none; toi is within the whole motion. Motions
/// are cut into equal straight steps of World, whose chords stray by a share of the tolerance, by
/// which the separation is widened: no contact is missed, and none is late. Bodies that meet at the
/// beginning are in contact at 0, by two faces of them. The same for any executor.
///
/// Throws Error if the tolerance is not positive, the separation is negative, or more than 2^24
/// steps were needed, and what World::update() and find_contacts() throw. Preconditions: those of
/// MeshView and Screw.
std::optional<Contact> first_contact(std::span<const MovingBody> bodies,
                                     const RigidContactOptions& options = {},
                                     Executor& executor = Executor::serial());

}  // namespace earshot::collision
