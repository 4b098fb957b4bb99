// SPDX-License-Identifier: MIT
#include "earshot/collision/rigid_contacts.h"

#include "earshot/base/error.h"
#include "earshot/collision/world.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace earshot::collision {

using geometry::Vec3;

namespace {

constexpr double kMostSteps = 0x1p24;

void check(const RigidContactOptions& options) {
    if (!(options.tolerance > 0.0) || !std::isfinite(options.tolerance)) {
        throw Error("tolerance", "is not positive", "give metres, such as 1e-3");
    }
    if (!(options.min_separation >= 0.0) || !std::isfinite(options.min_separation)) {
        throw Error("minimum separation", "is negative or not finite", "give metres, or 0");
    }
}

double steps_of(std::span<const MovingBody> bodies, double tolerance) {
    double steps = 1.0;
    for (const MovingBody& body : bodies) {
        const double bound = body.motion.acceleration_bound(body.mesh.positions);
        steps = std::max(steps, linear_step_count(bound, tolerance));
    }
    if (!(steps <= kMostSteps)) {
        throw Error("motion",
                    "more than 2^24 straight steps were needed",
                    "allow a larger tolerance, or cut the motion");
    }
    return steps;
}

/// All vertices of the bodies at a time.
std::vector<std::vector<Vec3>> place(std::span<const MovingBody> bodies, double time) {
    std::vector<std::vector<Vec3>> placed;
    for (const MovingBody& body : bodies) {
        const Pose pose = body.motion.at(time);
        std::vector<Vec3>& positions = placed.emplace_back();
        for (const Vec3& position : body.mesh.positions) {
            positions.push_back(pose.apply(position));
        }
    }
    return placed;
}

/// The time in the whole motion, not rounded up.
double time_within(double step, double toi, double steps) {
    return (step + toi) / steps * (1.0 - 0x1p-50);
}

}  // namespace

std::optional<Contact> first_contact(std::span<const MovingBody> bodies,
                                     const RigidContactOptions& options,
                                     Executor& executor) {
    check(options);
    // Both bodies of a pair stray, by an eighth of the tolerance each with what rounding adds; the
    // search for when they come near has its own tolerance, twice.
    const double steps = steps_of(bodies, options.tolerance / 9.0);
    const bool is_exact = options.min_separation == 0.0 &&
                          std::all_of(bodies.begin(), bodies.end(), [](const MovingBody& body) {
                              return body.motion.acceleration_bound(body.mesh.positions) == 0.0;
                          });
    ContactOptions each{
        .filter =
            [&](std::uint32_t a, std::uint32_t b) {
                const bool moves =
                    !bodies[a].motion.screws.empty() || !bodies[b].motion.screws.empty();
                return moves && (!options.filter || options.filter(a, b));
            },
        .min_separation = is_exact ? 0.0 : options.min_separation + 0.25 * options.tolerance,
        .tolerance = 0.25 * options.tolerance};
    World world;
    for (const MovingBody& body : bodies) {
        world.add_mesh(body.mesh.triangles, body.mesh.positions.size());
    }
    std::vector<std::vector<Vec3>> begin = place(bodies, 0.0);
    for (double step = 0.0; step < steps; step += 1.0) {
        std::vector<std::vector<Vec3>> end = place(bodies, (step + 1.0) / steps);
        for (std::uint32_t body = 0; body < bodies.size(); ++body) {
            world.update(body, begin[body], end[body]);
        }
        // What reaches through each other without touching elements does so from the beginning.
        if (step == 0.0) {
            const std::vector<Contact> contacts = world.contacts_at_begin(each, executor);
            if (!contacts.empty()) {
                return contacts.front();
            }
        }
        if (std::optional<Contact> contact = world.first_contact(each, executor)) {
            contact->toi = time_within(step, contact->toi, steps);
            return contact;
        }
        begin = std::move(end);
    }
    return std::nullopt;
}

}  // namespace earshot::collision
