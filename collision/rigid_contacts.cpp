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

constexpr double kMaxSteps = 0x1p24;

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
    if (!(steps <= kMaxSteps)) {
        throw Error("motion",
                    "more than 2^24 linear steps were needed",
                    "allow a larger tolerance, or cut the motion");
    }
    return steps;
}

/// World positions of all bodies' vertices at a time.
std::vector<std::vector<Vec3>> positions_at(std::span<const MovingBody> bodies, double time) {
    std::vector<std::vector<Vec3>> positions_of_bodies;
    for (const MovingBody& body : bodies) {
        const Pose pose = body.motion.at(time);
        std::vector<Vec3>& positions = positions_of_bodies.emplace_back();
        for (const Vec3& position : body.mesh.positions) {
            positions.push_back(pose.apply(position));
        }
    }
    return positions_of_bodies;
}

/// The time within the whole motion, rounded down.
double time_within(double step, double toi, double steps) {
    return (step + toi) / steps * (1.0 - 0x1p-50);
}

}  // namespace

std::optional<Contact> first_contact(std::span<const MovingBody> bodies,
                                     const RigidContactOptions& options,
                                     Executor& executor) {
    check(options);
    // Both bodies of a pair deviate from their chords, each by an eighth of the tolerance with
    // rounding; the minimum-separation search adds its own tolerance twice.
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
    std::vector<std::vector<Vec3>> begin = positions_at(bodies, 0.0);
    for (double step = 0.0; step < steps; step += 1.0) {
        std::vector<std::vector<Vec3>> end = positions_at(bodies, (step + 1.0) / steps);
        for (std::uint32_t body = 0; body < bodies.size(); ++body) {
            world.update(body, begin[body], end[body]);
        }
        // Bodies that intersect without elementary contacts do so from the beginning.
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
