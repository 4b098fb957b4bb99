// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/candidate_sequences.h"

#include <glm/geometric.hpp>

#include <bit>
#include <cmath>
#include <iterator>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

namespace {

/// Whether a facet may be the last reflection of sound in a frustum on its way to a listener. The
/// test is conservative: the reflection point must lie in the facet's box and in the frustum.
/// Obstacles are ignored, because PathVerifier tests for them. `position_error`: metres, at least
/// the rounding error that PathVerifier allows for.
bool may_be_last_reflection(const FacetIndex& index,
                            const Frustum& frustum,
                            FacetId facet,
                            const Vec3& listener,
                            double position_error) noexcept {
    const Plane& plane = index.plane(facet);
    const double apex_height = plane.distance(frustum.apex);
    const double listener_height = plane.distance(listener);
    // PathVerifier rejects an apex in the plane, and accepts a listener that lies behind the plane
    // by at most its slack.
    if (std::abs(apex_height) <= kRounding * index.extent() ||
        (apex_height > 0.0 ? listener_height < -position_error
                           : listener_height > position_error)) {
        return false;
    }
    // The reflection point is where the line from the apex to the mirrored listener intersects the
    // plane. If both heights are small, their errors dominate the error of the point.
    const double height_sum = std::abs(apex_height) + std::abs(listener_height);
    const Vec3 point = frustum.apex + (std::abs(apex_height) / height_sum) *
                                          (plane.mirror(listener) - frustum.apex);
    const double path_length = glm::distance(frustum.apex, listener) + height_sum;
    const double slack = position_error * (4.0 + 4.0 * path_length / height_sum);
    const geometry::Aabb& box = index.box(facet);
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        if (point[k] < static_cast<double>(box.lower[axis]) - slack ||
            point[k] > static_cast<double>(box.upper[axis]) + slack) {
            return false;
        }
    }
    const Vec3 p = frustum.local(point);
    const double margin = 4.0 * slack;
    return p.x >= frustum.rect.lower.x * p.z - margin &&
           p.x <= frustum.rect.upper.x * p.z + margin &&
           p.y >= frustum.rect.lower.y * p.z - margin && p.y <= frustum.rect.upper.y * p.z + margin;
}

}  // namespace

void TaskResult::append(TaskResult&& other) {
    std::move(other.paths.begin(), other.paths.end(), std::back_inserter(paths));
    statistics.frusta += other.statistics.frusta;
    statistics.candidates += other.statistics.candidates;
}

CandidateGenerator::CandidateGenerator(const FacetIndex& index,
                                       const PathVerifier& verifier,
                                       const ListenerSet& listeners,
                                       const TraceOptions& options,
                                       double max_radius,
                                       const Vec3& source)
    : index_(index),
      verifier_(verifier),
      listeners_(listeners),
      options_(options),
      max_radius_(max_radius),
      images_{source} {}

void CandidateGenerator::push(FacetId facet) {
    sequence_.push_back(facet);
    images_.push_back(index_.plane(facet).mirror(images_.back()));
}

void CandidateGenerator::pop() {
    sequence_.pop_back();
    images_.pop_back();
}

void CandidateGenerator::generate_direct() {
    for (std::size_t i = 0; i < listeners_.positions.size(); ++i) {
        verify_candidate(i);
    }
}

// The distance from the image source equals the length of the verified path, bit for bit.
void CandidateGenerator::verify_candidate(std::size_t listener) {
    const Vec3& position = listeners_.positions[listener];
    if (!within_limits(glm::distance(images_.back(), position))) {
        return;
    }
    ++result_.statistics.candidates;
    auto path = verifier_.verify(sequence_, images_, position);
    if (path && path->triangles.size() <= static_cast<std::size_t>(options_.max_order)) {
        path->listener = listener;
        result_.paths.push_back(std::move(*path));
    }
}

bool CandidateGenerator::within_limits(double length) const noexcept {
    double factor = 1.0;
    if (options_.min_pressure > 0.0) {
        for (const FacetId facet : sequence_) {
            factor *= index_.max_pressure_factor(facet);
        }
    }
    return length <= options_.max_length && !(factor < options_.min_pressure * length);
}

void CandidateGenerator::generate_from(const VisibleFacets& search,
                                       std::span<const VisibleFacet> visible_facets) {
    if (listeners_.beams == nullptr) {
        verify_listeners_in_frusta(search, visible_facets);
        return;
    }
    aperture_test_ = search.aperture_test();
    const auto next_order = static_cast<int>(order()) + 1;
    for (const VisibleFacet& visible : visible_facets) {
        connect_last_reflections(search, visible);
        if (next_order + 1 == options_.max_order) {
            connect_last_two_reflections(search, visible);
            connect_grazing_facets(search, visible);
        }
    }
}

template <typename Item, typename Visit>
void CandidateGenerator::for_each_in_aperture(const VisibleFacets& search,
                                              const VisibleFacet& visible,
                                              const PointsByFacet<Item>& stored,
                                              Visit&& visit) {
    const auto blocks = stored.blocks(visible.facet);
    if (blocks.empty()) {
        return;
    }
    for (int k = 0; k < 2; ++k) {
        aperture_test_.lower[k] = visible.aperture.lower[k];
        aperture_test_.upper[k] = visible.aperture.upper[k];
    }
    inside_masks_.resize(blocks.size());
    find_points_inside(aperture_test_, blocks, inside_masks_);
    const auto items = stored.items(visible.facet);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        for (std::uint32_t bits = inside_masks_[block]; bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
            const auto& coordinate = blocks[block].coordinate;
            const Vec3 point = {coordinate[0][lane], coordinate[1][lane], coordinate[2][lane]};
            if (search.may_pass(visible, point)) {
                visit(items[PointBlock::kWidth * block + lane]);
            }
        }
    }
}

// The visible facet is the last reflection: sound travels from it directly to a listener that it is
// visible from.
void CandidateGenerator::connect_last_reflections(const VisibleFacets& search,
                                                  const VisibleFacet& visible) {
    for_each_in_aperture(
        search, visible, listeners_.beams->last_reflections(), [&](const LastReflection& last) {
            if (search.may_reflect_to(visible, listeners_.positions[last.listener])) {
                push(visible.facet);
                verify_candidate(last.listener);
                pop();
            }
        });
}

// The visible facet is the last but one reflection: it is visible in the mirror image of a listener
// in the last facet.
void CandidateGenerator::connect_last_two_reflections(const VisibleFacets& search,
                                                      const VisibleFacet& visible) {
    const ListenerBeams& beams = *listeners_.beams;
    for_each_in_aperture(
        search, visible, beams.last_two_reflections(), [&](const LastTwoReflections& reflections) {
            push(visible.facet);
            if (beams.may_arrive_from(reflections, images_.back())) {
                push(reflections.last);
                verify_candidate(reflections.listener);
                pop();
            }
            pop();
        });
}

// The visible facet is the last but one reflection, and the plane of the last facet contains the
// listener.
void CandidateGenerator::connect_grazing_facets(const VisibleFacets& search,
                                                const VisibleFacet& visible) {
    const auto grazing_facets = listeners_.beams->grazing_facets();
    if (grazing_facets.empty()) {
        return;
    }
    const Frustum& parent = search.frustum();
    const Frustum child =
        mirrored(parent, index_.plane(visible.facet), visible.facet, visible.aperture);
    const double position_error =
        4.0 * kRounding * (index_.extent() + max_radius_ + glm::length(child.apex));
    for (const ListenerBeams::GrazingFacet& last : grazing_facets) {
        const Vec3& listener = listeners_.positions[last.listener];
        if (last.facet != visible.facet &&
            may_be_last_reflection(index_, child, last.facet, listener, position_error)) {
            push(visible.facet);
            push(last.facet);
            verify_candidate(last.listener);
            pop();
            pop();
        }
    }
}

// Forward-only tracing: verifies the candidates for listeners in the frustum itself and, at the
// last order that is traced, for those in the frusta that its visible facets reflect.
void CandidateGenerator::verify_listeners_in_frusta(const VisibleFacets& search,
                                                    std::span<const VisibleFacet> visible_facets) {
    const Frustum& frustum = search.frustum();
    const double position_error =
        4.0 * kRounding * (index_.extent() + max_radius_ + glm::length(frustum.apex));
    const auto for_each_in = [&](const Frustum& region, auto&& may_arrive_at) {
        const BoxCull cull(
            region, region.starts_at_facet ? &index_.plane(region.facet) : nullptr, position_error);
        listeners_.points->visit_in(cull, [&](std::uint32_t listener) {
            if (may_arrive_at(listeners_.positions[listener])) {
                verify_candidate(listener);
            }
        });
    };
    if (order() > 0) {
        for_each_in(frustum, [&](const Vec3& listener) { return search.may_arrive_at(listener); });
    }
    if (static_cast<int>(order()) + 1 < options_.max_order) {
        return;
    }
    for (const VisibleFacet& visible : visible_facets) {
        const Frustum child =
            mirrored(frustum, index_.plane(visible.facet), visible.facet, visible.aperture);
        push(visible.facet);
        for_each_in(child,
                    [&](const Vec3& listener) { return search.may_reflect_to(visible, listener); });
        pop();
    }
}

}  // namespace earshot::frustum
