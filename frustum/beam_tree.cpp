// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/beam_tree.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace earshot::frustum {

using geometry::Vec3;

namespace {

// Complete mode: one frustum per cube face was fastest in scenes of 6 to 3,000 facets, by a tenth
// to a third over 32 sub-frusta and more.
constexpr int kCompleteResolution = 8;
constexpr int kSampledResolution = 32;

/// How finely the frusta around a source are searched. What the search spares are frusta of the
/// first reflection, or where none are traced, connections with subpaths. Paths of up to two
/// reflections have too few of either.
int primary_pieces(const TraceOptions& options, int orders) noexcept {
    if (options.mode != Mode::complete || options.resolution > 0 || options.max_order < 3) {
        return 1;
    }
    return orders > 1 ? kPrimaryPieces : kPrimaryPieces / 4;
}

}  // namespace

BeamTracer::BeamTracer(const FacetIndex& index,
                       const TraceOptions& options,
                       double contact_radius,
                       double max_radius,
                       int orders,
                       GrazingFacets grazing_facets)
    : index_(index),
      options_(options),
      contact_radius_(contact_radius),
      max_radius_(max_radius),
      orders_(orders),
      grazing_facets_(grazing_facets),
      primary_pieces_(primary_pieces(options, orders)) {}

VisibleFacets BeamTracer::make_search() const {
    return {index_, options_.mode, contact_radius_, max_radius_, grazing_facets_};
}

std::vector<Frustum> BeamTracer::frusta_around_source(const Vec3& source) const {
    const int default_resolution =
        options_.mode == Mode::complete ? kCompleteResolution : kSampledResolution;
    const int resolution = options_.resolution > 0 ? options_.resolution : default_resolution;
    const int cells = std::min(resolution, kGridSide);
    const int pieces = (resolution + cells - 1) / cells;
    const double min_depth = 0.5 * kRounding * index_.extent();
    return frusta_around(source, pieces, cells, min_depth);
}

// A path over the facet is at least as long as the way from the image source to the facet's box.
bool BeamTracer::may_reflect(const Frustum& frustum, const VisibleFacet& visible) const {
    if (visible.grazing) {
        return false;
    }
    constexpr double kRoundedDown = 1.0 - 0x1p-30;  // for the rounding of this bound
    const geometry::Aabb& box = index_.box(visible.facet);
    Vec3 closest;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        closest[k] = std::clamp(frustum.apex[k],
                                static_cast<double>(box.lower[axis]),
                                static_cast<double>(box.upper[axis]));
    }
    const double length = kRoundedDown * glm::distance(frustum.apex, closest);
    const double factor = frustum.max_pressure_factor * index_.max_pressure_factor(visible.facet);
    return length <= options_.max_length &&
           !(factor < kRoundedDown * options_.min_pressure * length);
}

// The image source and the facet tell frusta of one source apart, but for those of several pieces
// of the sphere around it, which are followed together.
bool BeamTracer::is_followed(const Frustum& frustum, std::size_t order) const {
    if (sample_.share >= 1.0 || static_cast<int>(order) != sample_.order) {
        return true;
    }
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    return random(bits(frustum.apex.x),
                  bits(frustum.apex.y),
                  bits(frustum.apex.z) + frustum.facet) < sample_.share;
}

void BeamRecorder::record(const Frustum& frustum,
                          std::span<const VisibleFacet> visible,
                          const OccluderDepths& occluders,
                          bool is_continued,
                          std::span<const std::uint32_t> before) {
    const std::size_t begin = tree_.visible.size();
    if (!before.empty()) {
        tree_.visible_before.resize(begin, kNotBefore);
        tree_.visible_before.insert(tree_.visible_before.end(), before.begin(), before.end());
    }
    tree_.visible.insert(tree_.visible.end(), visible.begin(), visible.end());
    tree_.nodes.push_back({frustum, order_, begin, tree_.visible.size(), is_continued, occluders});
}

}  // namespace earshot::frustum
