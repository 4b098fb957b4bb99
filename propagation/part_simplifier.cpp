// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/part_simplifier.h"

#include "earshot/geometry/simplify.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::OrientedBox;
using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

constexpr std::size_t kBoxTriangles = 12;

/// The distances are proved to this share of the one asked for.
constexpr double kResolutionShare = 0.1;

/// Without a size, boxes are tried for parts of up to so many distances: a solid cube of four
/// distances has no point farther than one from the faces but its middle.
constexpr double kBoxDistances = 4.0;

/// A box thinner than this, in metres, is a rectangle: twice what single precision rounds off at
/// the size of rooms.
constexpr double kMinBoxThickness = 1e-5;

Vec3 as_single(const Vec3& p) {
    return {static_cast<double>(static_cast<float>(p.x)),
            static_cast<double>(static_cast<float>(p.y)),
            static_cast<double>(static_cast<float>(p.z))};
}

bool is_rectangle(const OrientedBox& box) {
    return 2.0 * box.half_size.z < kMinBoxThickness;
}

/// With corners as files store them.
Mesh mesh_of(const OrientedBox& box) {
    Mesh mesh;
    const auto add_corner = [&](double x, double y, double z) {
        mesh.positions.push_back(as_single(box.centre + x * box.half_size.x * box.axes[0] +
                                           y * box.half_size.y * box.axes[1] +
                                           z * box.half_size.z * box.axes[2]));
    };
    const auto add_quad = [&](VertexId a, VertexId b, VertexId c, VertexId d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    if (is_rectangle(box)) {
        add_corner(-1, -1, 0);
        add_corner(1, -1, 0);
        add_corner(1, 1, 0);
        add_corner(-1, 1, 0);
        add_quad(0, 1, 2, 3);
        return mesh;
    }
    for (const double z : {-1.0, 1.0}) {
        add_corner(-1, -1, z);
        add_corner(1, -1, z);
        add_corner(1, 1, z);
        add_corner(-1, 1, z);
    }
    add_quad(3, 2, 1, 0);
    add_quad(4, 5, 6, 7);
    for (VertexId i = 0; i < 4; ++i) {
        const VertexId next = (i + 1) % 4;
        add_quad(i, next, next + 4, i + 4);
    }
    return mesh;
}

SurfaceChange measured(const Mesh& original, const Mesh& simplified, double resolution) {
    return {
        .to_simplified = bvh::one_sided_distance(original.view(), simplified.view(), resolution),
        .to_original = bvh::one_sided_distance(simplified.view(), original.view(), resolution)};
}

}  // namespace

void SurfaceChange::include(const SurfaceChange& other) noexcept {
    const auto take = [](const bvh::SurfaceDistance& from, bvh::SurfaceDistance& to) {
        to.lower = std::max(to.lower, from.lower);
        to.upper = std::max(to.upper, from.upper);
        to.rms = std::max(to.rms, from.rms);
    };
    take(other.to_simplified, to_simplified);
    take(other.to_original, to_original);
}

double reached_sides(bool is_closed, const Material& material) {
    return is_closed || material.one_sided ? 1.0 : 2.0;
}

PartSimplifier::PartSimplifier(const Scene& scene,
                               std::span<const SurfaceLabel> labels,
                               std::span<const Vec3> points,
                               const SimplificationOptions& options)
    : scene_(scene), labels_(labels), points_(points), options_(options) {}

SimplifiedPart PartSimplifier::simplify(const MeshPart& part) const {
    if (std::optional<SimplifiedPart> box = as_box(part)) {
        return *std::move(box);
    }
    return decimated(part);
}

bool PartSimplifier::may_be_box(const MeshPart& part, const OrientedBox& box) const {
    const double max_size = options_.max_object_size > 0.0 ? options_.max_object_size
                                                           : kBoxDistances * options_.max_distance;
    // A closed part whose fronts face inside is a room.
    if (2.0 * box.half_size.x > max_size || (part.is_closed && part.volume < 0.0)) {
        return false;
    }
    return std::none_of(points_.begin(), points_.end(), [&](const Vec3& point) {
        bool is_inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const double along =
                glm::dot(point - box.centre, box.axes[static_cast<std::size_t>(axis)]);
            is_inside = is_inside && std::abs(along) <= box.half_size[axis] + options_.max_distance;
        }
        return is_inside;
    });
}

bool PartSimplifier::can_absorb(const SimplifiedPart& box) const {
    const audio::Bands& bands = audio::Bands::octaves();
    audio::Spectrum sum{};
    double area = 0.0;
    for (const SimplifiedPart::LabelUse& use : box.uses) {
        const audio::Spectrum absorption =
            scene_.materials[labels_[use.label].material].absorption.over(bands);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            sum[band] += use.area_before * absorption[band];
        }
        area += use.area_after;
    }
    return std::all_of(sum.begin(),
                       sum.begin() + static_cast<std::ptrdiff_t>(bands.count()),
                       [&](double absorbed) { return absorbed <= area; });
}

void PartSimplifier::measure_labels(const MeshPart& part, SimplifiedPart& simplified) const {
    std::vector<std::uint32_t> present = part.labels;
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    for (const std::uint32_t label : present) {
        const Material& material = scene_.materials[labels_[label].material];
        const Mesh before = with_label(part.mesh, part.labels, label);
        const Mesh after = with_label(simplified.mesh, simplified.labels, label);
        SimplifiedPart::LabelUse use{
            .label = label,
            .area_before = reached_sides(part.is_closed, material) * surface_area(before),
            .area_after = reached_sides(simplified.is_closed, material) * surface_area(after),
            .triangles_before = before.triangles.size(),
            .triangles_after = after.triangles.size()};
        if (!simplified.box && !simplified.is_kept) {
            const SurfaceChange change =
                measured(before, after, kResolutionShare * options_.max_distance);
            simplified.change.include(change);
            use.rms_distance = change.to_simplified.rms;
        }
        simplified.uses.push_back(use);
    }
}

std::optional<SimplifiedPart> PartSimplifier::as_box(const MeshPart& part) const {
    if (!options_.boxes || part.mesh.triangles.size() <= kBoxTriangles) {
        return std::nullopt;
    }
    std::vector<geometry::TriangleId> all(part.mesh.triangles.size());
    std::iota(all.begin(), all.end(), geometry::TriangleId{0});
    const OrientedBox box = geometry::fit_box(part.mesh.view(), all);
    if (!may_be_box(part, box)) {
        return std::nullopt;
    }
    SimplifiedPart simplified{.mesh = mesh_of(box),
                              .labels = {},
                              .is_closed = !is_rectangle(box),
                              .triangles_before = part.mesh.triangles.size(),
                              .change = {},
                              .box = box,
                              .uses = {}};
    // The label of most of its area, the lowest of equals.
    std::vector<std::uint32_t> present = part.labels;
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    std::uint32_t main_label = present.front();
    double main_area = -1.0;
    for (const std::uint32_t label : present) {
        const double area = surface_area(with_label(part.mesh, part.labels, label));
        if (area > main_area) {
            main_area = area;
            main_label = label;
        }
    }
    simplified.labels.assign(simplified.mesh.triangles.size(), main_label);
    simplified.volume = simplified.is_closed ? enclosed_volume(simplified.mesh) : 0.0;
    measure_labels(part, simplified);
    simplified.change =
        measured(part.mesh, simplified.mesh, kResolutionShare * options_.max_distance);
    const double rms =
        std::max(simplified.change.to_simplified.rms, simplified.change.to_original.rms);
    for (SimplifiedPart::LabelUse& use : simplified.uses) {
        use.rms_distance = rms;
    }
    const bool keeps_distance =
        options_.max_object_size > 0.0 || simplified.change.upper() <= options_.max_distance;
    return keeps_distance && can_absorb(simplified) ? std::optional(std::move(simplified))
                                                    : std::nullopt;
}

SimplifiedPart PartSimplifier::decimated(const MeshPart& part) const {
    // Samples do not see everything: where the measure finds more than the distance, simplify by
    // less and with more samples.
    struct Attempt {
        double share;
        int samples_per_edge;
        bool sharpen;
    };
    constexpr std::array<Attempt, 6> kAttempts = {{{1.0, 3, true},
                                                   {1.0, 6, false},
                                                   {0.8, 8, true},
                                                   {0.5, 16, false},
                                                   {0.25, 32, false},
                                                   {0.0, 32, false}}};
    for (const Attempt& attempt : kAttempts) {
        geometry::SimplifiedMesh found =
            geometry::simplify(part.mesh.view(),
                               part.labels,
                               {.max_distance = attempt.share * options_.max_distance,
                                .max_angle = options_.max_angle,
                                .sharpen = attempt.sharpen,
                                .samples_per_edge = attempt.samples_per_edge});
        SimplifiedPart simplified{.mesh = std::move(found.mesh),
                                  .labels = {},
                                  .triangles_before = part.mesh.triangles.size(),
                                  .is_tightened = &attempt != kAttempts.data(),
                                  .change = {},
                                  .box = {},
                                  .uses = {}};
        for (const geometry::TriangleId origin : found.origins) {
            simplified.labels.push_back(part.labels[origin]);
        }
        simplified.is_closed = is_closed_surface(simplified.mesh);
        simplified.volume = simplified.is_closed ? enclosed_volume(simplified.mesh) : 0.0;
        measure_labels(part, simplified);
        if (simplified.change.upper() <= options_.max_distance &&
            simplified.is_closed == part.is_closed) {
            return simplified;
        }
    }
    SimplifiedPart kept{.mesh = part.mesh,
                        .labels = part.labels,
                        .is_closed = part.is_closed,
                        .volume = part.volume,
                        .triangles_before = part.mesh.triangles.size(),
                        .is_kept = true,
                        .change = {},
                        .box = {},
                        .uses = {}};
    measure_labels(part, kept);
    return kept;
}

}  // namespace earshot::propagation
