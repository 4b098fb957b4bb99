// SPDX-License-Identifier: MIT
// The bounds by which rays are culled in single precision, attacked at random: the decision in
// double precision never contradicts them, and does where any term is left out.
#include "earshot/base/random.h"
#include "earshot/base/simd.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/sheared_ray.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "bvh/encounter.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bvh/float_bounds_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"
#include "earshot/bvh/kernels/packet-inl.h"
#include "earshot/bvh/kernels/packet_gather-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

template <typename Terms>
struct WithoutDepth : Terms {
    static constexpr float kDepth = 0.0F;
};
template <typename Terms>
struct WithoutLateral : Terms {
    static constexpr float kLateral = 0.0F;
};
template <typename Terms>
struct WithoutEdge : Terms {
    static constexpr float kEdge = 0.0F;
};
struct WithoutKnown : ProvenTerms {
    static constexpr float kMaxKnown = 1e30F;
};
struct WithoutSpread : ProvenTerms {
    static constexpr float kSpread = 0.0F;
};
template <typename Terms>
struct WithoutDistance : Terms {
    static constexpr float kDistance = 0.0F;
};

/// The bounds of one triangle, in the first lane.
struct TriangleBounds {
    bool is_possible = false, is_certain = false;
    float near = 0.0F, far = 0.0F;
};

template <typename Terms>
TriangleBounds bounds_of(const FloatRay& ray, const Encounter& encounter) {
    std::uint32_t words[9 + 1 + WideTree::kPaddingWords] = {};
    for (std::size_t k = 0; k < 9; ++k) {
        words[k] = std::bit_cast<std::uint32_t>(
            static_cast<float>(encounter.corners[k / 3][static_cast<int>(k % 3)]));
    }
    const ShearedLanes at = shear(ray, {words, 1});
    const ConservativeHits hits = EdgeTest<Terms>(at).bounds(at, 1);
    alignas(32) float near[8], far[8];
    hits.near.store(near);
    hits.far.store(far);
    return {any(hits.possible), any(hits.certain), near[0], far[0]};
}

template <typename Terms>
bool contradicts_ray(const FloatRay& ray, const Encounter& encounter) {
    const TriangleBounds bounds = bounds_of<Terms>(ray, encounter);
    if (encounter.hit) {
        const double t = encounter.hit->t;
        return !bounds.is_possible || !(bounds.near <= t) || !(t <= bounds.far);
    }
    return bounds.is_certain && bounds.near >= 0.0F;
}

template <typename Terms>
bool contradicts_segment(const FloatRay& ray, const Encounter& encounter) {
    const TriangleBounds bounds = bounds_of<Terms>(ray, encounter);
    if (encounter.touches) {
        return !bounds.is_possible || !(bounds.near <= 1.0F) || !(0.0F <= bounds.far);
    }
    return bounds.is_certain && bounds.near > 0.0F && bounds.far < 1.0F;
}

template <typename Terms>
bool contradicts(const FloatRay& ray, const FloatRay& along_segment, const Encounter& encounter) {
    return contradicts_ray<Terms>(ray, encounter) ||
           contradicts_segment<Terms>(along_segment, encounter);
}

/// A node whose children all have this box.
WideNode node_of(const geometry::Aabb& box) {
    WideNode node{};
    for (std::size_t k = 0; k < 3; ++k) {
        std::fill_n(node.planes[2 * k], WideNode::kWidth, box.lower[k]);
        std::fill_n(node.planes[2 * k + 1], WideNode::kWidth, box.upper[k]);
    }
    return node;
}

/// A triangle's box that double precision passes is passed, and entered no later.
bool contradicts_box(const FloatRay& ray, const Encounter& encounter) {
    if (encounter.box_interval.is_empty()) {
        return false;
    }
    const auto [a, b, c] = encounter.corners;
    const WideNode node = node_of(geometry::triangle_box(a, b, c));
    const auto [near, far] = SlabTest(ray)(node, Float8(ray.t_max));
    alignas(32) float entry[8];
    near.store(entry);
    return !any(near <= far) || !(entry[0] <= encounter.box_interval.min);
}

bool is_contradicted(const Encounter& encounter, Omitted omitted) {
    const auto reach = geometry::round_up(encounter.reach);
    FloatRay ray, along_segment;
    if (!set_ray(ray, encounter.ray, reach) ||
        !set_segment(along_segment, encounter.segment, reach)) {
        return false;
    }
    switch (omitted) {
        case Omitted::none:
            return contradicts<ProvenTerms>(ray, along_segment, encounter) ||
                   contradicts_box(ray, encounter);
        case Omitted::corner:
            ray.corner_error = along_segment.corner_error = 0.0F;
            return contradicts<ProvenTerms>(ray, along_segment, encounter);
        case Omitted::depth:
            return contradicts<WithoutDepth<ProvenTerms>>(ray, along_segment, encounter);
        case Omitted::lateral:
            return contradicts<WithoutLateral<ProvenTerms>>(ray, along_segment, encounter);
        case Omitted::edge:
            return contradicts<WithoutEdge<ProvenTerms>>(ray, along_segment, encounter);
        case Omitted::known:
            return contradicts<WithoutKnown>(ray, along_segment, encounter);
        case Omitted::spread:
            return contradicts<WithoutSpread>(ray, along_segment, encounter);
        case Omitted::distance:
            return contradicts<WithoutDistance<ProvenTerms>>(ray, along_segment, encounter);
        case Omitted::plane_pad:
            for (std::size_t k = 0; k < 3; ++k) {
                ray.offset_near[k] = -ray.origin[k] * ray.inverse[k];
                ray.offset_far[k] = -ray.origin[k] * ray.inverse[k];
            }
            return contradicts_box(ray, encounter);
    }
    return false;
}

/// The triangle against the rays of a packet, of which the first is `ray`.
template <typename Terms>
bool contradicts_packet(const PacketEncounter& encounter, RayPacket& packet) {
    std::uint32_t words[9 + 1 + WideTree::kPaddingWords] = {};
    for (std::size_t k = 0; k < 9; ++k) {
        words[k] = std::bit_cast<std::uint32_t>(
            static_cast<float>(encounter.corners[k / 3][static_cast<int>(k % 3)]));
    }
    EdgeFunctions edges;
    set_up_edge_functions<Terms>({words, 1}, packet, kMaxBound, edges);
    if (edges.possible != 0) {
        intersect_triangle(edges, 0, 0, packet, [](std::size_t) {});
    }
    for (std::size_t i = 0; i < packet.count; ++i) {
        const bool is_candidate = packet.candidate_near[i] <= packet.bound[i];
        if (encounter.hits[i]) {
            const double depth =
                encounter.hits[i]->t *
                std::abs(encounter.rays[i].direction[static_cast<int>(packet.axis[2])]);
            if (!is_candidate || !(packet.candidate_near[i] <= depth) ||
                !(depth <= packet.bound[i])) {
                return true;
            }
        } else if (packet.bound[i] < kMaxBound) {
            return true;
        }
    }
    return false;
}

/// The triangle's box against the frustum of the packet.
bool contradicts_frustum(const PacketEncounter& encounter, const RayPacket& packet) {
    const auto [a, b, c] = encounter.corners;
    const WideNode node = node_of(geometry::triangle_box(a, b, c));
    const auto [near, far] = PacketFrustum(packet)(node, Float8(kMaxBound));
    const bool is_passed = any(near <= far);
    for (std::size_t i = 0; i < packet.count; ++i) {
        if (!encounter.box_intervals[i].is_empty() && !is_passed) {
            return true;
        }
    }
    return false;
}

bool is_packet_contradicted(const PacketEncounter& encounter, Omitted omitted) {
    RayPacket packet;
    if (gather_packet(packet, encounter.rays, geometry::round_up(encounter.reach)) == 0) {
        return false;
    }
    switch (omitted) {
        case Omitted::corner:
            packet.corner_error = 0.0F;
            return contradicts_packet<PacketTerms>(encounter, packet);
        case Omitted::depth:
            return contradicts_packet<WithoutDepth<PacketTerms>>(encounter, packet);
        case Omitted::lateral:
            return contradicts_packet<WithoutLateral<PacketTerms>>(encounter, packet);
        case Omitted::edge:
            return contradicts_packet<WithoutEdge<PacketTerms>>(encounter, packet);
        case Omitted::distance:
            return contradicts_packet<WithoutDistance<PacketTerms>>(encounter, packet);
        case Omitted::plane_pad:
            packet.plane_error = 0.0F;
            return contradicts_frustum(encounter, packet);
        default:
            return contradicts_frustum(encounter, packet) ||
                   contradicts_packet<PacketTerms>(encounter, packet);
    }
}

std::size_t count_packet_contradictions(std::span<const PacketEncounter> encounters,
                                        Omitted omitted) {
    return static_cast<std::size_t>(
        std::count_if(encounters.begin(), encounters.end(), [&](const PacketEncounter& encounter) {
            return is_packet_contradicted(encounter, omitted);
        }));
}

std::size_t count_contradictions(std::span<const Encounter> encounters, Omitted omitted) {
    return static_cast<std::size_t>(
        std::count_if(encounters.begin(), encounters.end(), [&](const Encounter& encounter) {
            return is_contradicted(encounter, omitted);
        }));
}

/// How many of the rays that hit nothing single precision leaves open.
std::size_t count_open(std::span<const Encounter> encounters) {
    std::size_t open = 0;
    for (const Encounter& encounter : encounters) {
        FloatRay ray;
        if (!encounter.hit && set_ray(ray, encounter.ray, geometry::round_up(encounter.reach))) {
            const TriangleBounds bounds = bounds_of<ProvenTerms>(ray, encounter);
            open += bounds.is_possible && bounds.far >= 0.0F ? 1 : 0;
        }
    }
    return open;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(count_contradictions);
HWY_EXPORT(count_packet_contradictions);
HWY_EXPORT(count_open);

namespace {

using geometry::Vec3;

/// Random numbers of one encounter.
class Draw {
public:
    explicit Draw(std::uint64_t encounter) : encounter_(encounter) {}

    double between(double low, double high) {
        return random_between(71, ++stream_, encounter_, low, high);
    }
    /// 2 to a power between these.
    double power(double low, double high) { return std::exp2(between(low, high)); }
    std::uint64_t below(std::uint64_t count) {
        return random_bits(71, ++stream_, encounter_) % count;
    }
    /// In the cube [-1, 1]^3.
    Vec3 point() {
        const double x = between(-1.0, 1.0);
        const double y = between(-1.0, 1.0);
        return {x, y, between(-1.0, 1.0)};
    }

private:
    std::uint64_t encounter_, stream_ = 0;
};

/// A triangle of any size and shape in a scene that reaches to `reach`.
void draw_triangle(Draw& draw, Encounter& encounter) {
    const double size = encounter.reach * draw.power(-30.0, -2.0);
    auto& [a, b, c] = encounter.corners;
    a = 0.5 * encounter.reach * draw.point();
    b = a + size * draw.point();
    c = a + size * draw.point();
    if (draw.below(4) == 0) {  // a sliver
        c = a + draw.between(-0.5, 1.5) * (b - a) + size * draw.power(-30.0, -3.0) * draw.point();
    }
    if (draw.below(16) == 0) {  // in an axis-aligned plane
        const auto axis = static_cast<int>(draw.below(3));
        b[axis] = c[axis] = a[axis];
    }
}

/// A point in the triangle, on an edge or at a corner, or a little beside it.
Vec3 draw_target(Draw& draw, const Encounter& encounter) {
    const auto& [a, b, c] = encounter.corners;
    const double u = draw.below(3) == 0 ? 0.0 : draw.between(0.0, 1.0);
    const double v = draw.below(3) == 0 ? 1.0 - u : draw.between(0.0, 1.0 - u);
    const Vec3 target = a + u * (b - a) + v * (c - a);
    return target + encounter.reach * draw.power(-60.0, -18.0) * draw.point();
}

Vec3 draw_origin(Draw& draw, const Encounter& encounter, const Vec3& target) {
    const auto& [a, b, c] = encounter.corners;
    const double size = glm::length(b - a) + glm::length(c - a);
    switch (draw.below(4)) {
        case 0:
            return 0.5 * encounter.reach * draw.point();
        case 1:
            return target + size * draw.point();
        case 2:
            return target + size * draw.power(-20.0, 0.0) * draw.point();
        default:
            return encounter.reach * draw.power(0.0, 20.0) * draw.point();
    }
}

void decide(Encounter& encounter) {
    const auto& [a, b, c] = encounter.corners;
    const geometry::Ray& ray = encounter.ray;
    encounter.hit = geometry::ShearedRay(ray).hit(a, b, c, ray.t_max, encounter.reach);
    encounter.touches = geometry::touches(encounter.segment, a, b, c);
    encounter.box_interval = geometry::SlabTest(ray.origin, ray.direction, encounter.reach)
                                 .interval(geometry::triangle_box(a, b, c), ray.t_max);
}

/// A ray that passes far beside the scene, nearly along one axis, in the depth of the target.
geometry::Ray draw_distant(Draw& draw, const Encounter& encounter, const Vec3& target) {
    const auto axis = static_cast<int>(draw.below(3));
    geometry::Ray ray{target, draw.power(-20.0, -5.0) * draw.point()};
    ray.origin[axis] += encounter.reach * draw.power(5.0, 20.0);
    ray.origin[(axis + 2) % 3] += encounter.reach * draw.power(-5.0, 20.0);
    ray.direction[(axis + 1) % 3] = 1.0;
    return ray;
}

Encounter draw_encounter(std::uint64_t i) {
    Draw draw(i);
    Encounter encounter;
    encounter.reach = draw.power(-10.0, 10.0);
    draw_triangle(draw, encounter);
    const Vec3 target = draw_target(draw, encounter);
    const Vec3 near = draw_origin(draw, encounter, target);
    const bool is_distant = draw.below(8) == 0;
    const auto [from, way, end] =
        is_distant ? draw_distant(draw, encounter, target) : geometry::Ray{near, target - near};
    encounter.ray = {from, draw.power(-5.0, 5.0) * way};
    if (draw.below(8) == 0) {
        encounter.ray.direction[static_cast<int>(draw.below(3))] *= draw.power(-90.0, 0.0);
    }
    encounter.segment = {from, from + draw.between(0.5, 2.0) * way};
    decide(encounter);
    return encounter;
}

std::vector<Encounter> draw_encounters(std::uint64_t first, std::size_t count) {
    std::vector<Encounter> encounters;
    for (std::uint64_t i = first; i < first + count; ++i) {
        encounters.push_back(draw_encounter(i));
    }
    return encounters;
}

/// Packets about the rays of encounters.
std::vector<PacketEncounter> draw_packets(std::size_t count) {
    std::vector<PacketEncounter> packets;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Encounter encounter = draw_encounter(i);
        Draw draw(count + i);
        const double width = glm::length(encounter.ray.direction) * draw.power(-30.0, -4.0);
        PacketEncounter packet;
        std::copy_n(encounter.corners, 3, packet.corners);
        packet.reach = encounter.reach;
        const auto& [a, b, c] = packet.corners;
        for (std::size_t k = 0; k < PacketEncounter::kRays; ++k) {
            geometry::Ray& ray = packet.rays[k];
            ray = encounter.ray;
            ray.direction += k == 0 ? Vec3(0.0) : width * draw.point();
            packet.hits[k] = geometry::ShearedRay(ray).hit(a, b, c, ray.t_max, packet.reach);
            packet.box_intervals[k] = geometry::SlabTest(ray.origin, ray.direction, packet.reach)
                                          .interval(geometry::triangle_box(a, b, c), ray.t_max);
        }
        packets.push_back(packet);
    }
    return packets;
}

TEST(FloatBounds, OfPacketsAreNeverContradictedWithAnySimdTarget) {
    const auto packets = draw_packets(30000);
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(HWY_DYNAMIC_DISPATCH(count_packet_contradictions)(packets, Omitted::none), 0U)
            << target;
    }
    override_simd_target("auto");
}

TEST(FloatBounds, OfPacketsAreContradictedWithoutAnyTerm) {
    const auto packets = draw_packets(30000);
    for (const Omitted omitted : {Omitted::corner,
                                  Omitted::depth,
                                  Omitted::lateral,
                                  Omitted::edge,
                                  Omitted::distance,
                                  Omitted::plane_pad}) {
        EXPECT_GT(HWY_DYNAMIC_DISPATCH(count_packet_contradictions)(packets, omitted), 0U)
            << static_cast<int>(omitted);
    }
}

TEST(FloatBounds, AreNeverContradictedWithAnySimdTarget) {
    const auto encounters = draw_encounters(0, 100000);
    EXPECT_GT(
        std::count_if(
            encounters.begin(), encounters.end(), [](const auto& e) { return e.hit.has_value(); }),
        20000);
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(HWY_DYNAMIC_DISPATCH(count_contradictions)(encounters, Omitted::none), 0U)
            << target;
    }
    override_simd_target("auto");
}

TEST(FloatBounds, AreContradictedWithoutAnyTerm) {
    const auto encounters = draw_encounters(0, 100000);
    for (const Omitted omitted : {Omitted::corner,
                                  Omitted::depth,
                                  Omitted::lateral,
                                  Omitted::edge,
                                  Omitted::known,
                                  Omitted::spread,
                                  Omitted::distance,
                                  Omitted::plane_pad}) {
        EXPECT_GT(HWY_DYNAMIC_DISPATCH(count_contradictions)(encounters, omitted), 0U)
            << static_cast<int>(omitted);
    }
}

// A bound in proportion to the scene would be right, but useless where reflected rays start.
TEST(FloatBounds, DecideRaysThatLeaveASurface) {
    std::vector<Encounter> encounters;
    for (std::uint64_t i = 0; i < 10000; ++i) {
        Draw draw(i);
        Encounter encounter;
        encounter.reach = 1.0;
        auto& [a, b, c] = encounter.corners;
        a = 0.5 * draw.point();
        b = a + 0.01 * draw.point();
        c = a + 0.01 * draw.point();
        const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        const double u = draw.between(0.0, 1.0);
        const double v = draw.between(0.0, 1.0 - u);
        encounter.ray = {a + u * (b - a) + v * (c - a) + 1e-5 * normal,
                         glm::normalize(1.0001 * normal + glm::normalize(draw.point()))};
        decide(encounter);
        encounters.push_back(encounter);
    }
    EXPECT_LE(HWY_DYNAMIC_DISPATCH(count_open)(encounters), 500U);
}

}  // namespace
}  // namespace earshot::bvh
#endif
