// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/candidate_sequences.h"

#include "earshot/frustum/internal/beam_tree.h"

#include <glm/geometric.hpp>

#include <bit>
#include <cmath>
#include <iterator>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

void TaskResult::append(TaskResult&& other) {
    std::move(other.paths.begin(), other.paths.end(), std::back_inserter(paths));
    statistics += other.statistics;
    verdicts.append(std::move(other.verdicts));
    connections.append(other.connections);
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
    auto path = path_to(listener);
    if (path && path->triangles.size() <= static_cast<std::size_t>(options_.max_order)) {
        result_.paths.push_back(std::move(*path));
    }
}

// By a verdict that still holds, or by verification.
std::optional<SpecularPath> CandidateGenerator::path_to(std::size_t listener) {
    if (former_ != nullptr) {
        if (const auto verdict = former_->find(sequence_, listener)) {
            ++result_.statistics.kept_candidates;
            if (verdict->rejection) {
                result_.verdicts.add(sequence_, listener, *verdict->rejection);
                return std::nullopt;
            }
            result_.verdicts.add(sequence_, listener, *verdict->path);
            return *verdict->path;
        }
    }
    ++result_.statistics.candidates;
    Rejection rejection;
    auto path = verifier_.verify(sequence_, images_, listeners_.positions[listener], &rejection);
    if (path) {
        path->listener = listener;
    }
    if (former_ != nullptr) {
        if (path) {
            result_.verdicts.add(sequence_, listener, *path);
        } else {
            result_.verdicts.add(sequence_, listener, rejection);
        }
    }
    return path;
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
    for (const VisibleFacet& visible : visible_facets) {
        connect_last_reflections(search, visible);
        connect_subpaths(search, visible, kNotBefore);
    }
}

void CandidateGenerator::generate_from(const VisibleFacets& search,
                                       const BeamTree& part,
                                       const BeamNode& node,
                                       std::size_t first) {
    const auto visible_facets = part.visible_in(node);
    if (former_connections_ == nullptr || listeners_.beams == nullptr) {
        generate_from(search, visible_facets);
        return;
    }
    aperture_test_ = search.aperture_test();
    for (std::size_t i = 0; i < visible_facets.size(); ++i) {
        const std::size_t position = node.visible_begin + i;
        connect_last_reflections(search, visible_facets[i]);
        connect_subpaths(
            search,
            visible_facets[i],
            former_connections_->position(first + position, part.position_before(position)));
        result_.connections.add(connected_, taken_over_);
    }
}

// The visible facet is the last reflection: sound travels from it directly to a listener that it is
// visible from.
void CandidateGenerator::connect_last_reflections(const VisibleFacets& search,
                                                  const VisibleFacet& visible) {
    const auto& stored = listeners_.beams->last_reflections();
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
            const std::uint32_t listener = items[PointBlock::kWidth * block + lane].listener;
            if (search.may_reflect_to(visible, listeners_.positions[listener])) {
                push(visible.facet);
                verify_candidate(listener);
                pop();
            }
        }
    }
}

// Sound travels from the visible facet to the first facet of a subpath.
void CandidateGenerator::connect_subpaths(const VisibleFacets& search,
                                          const VisibleFacet& visible,
                                          std::uint32_t position_before) {
    connected_.clear();
    taken_over_ = 0;
    if (static_cast<int>(order()) != listeners_.connecting_order) {
        return;
    }
    const bool is_known = position_before != kNotBefore;
    if (is_known) {
        take_over_connections(visible, position_before);
    }
    if (!is_known || !former_connections_->are_of_now) {
        find_connections(search, visible, is_known);
    }
}

void CandidateGenerator::take_over_connections(const VisibleFacet& visible,
                                               std::uint32_t position_before) {
    const auto before = former_connections_->connections->of(position_before);
    if (before.empty()) {
        return;
    }
    push(visible.facet);
    for (const std::uint32_t number : before) {
        const std::uint32_t now =
            former_connections_->are_of_now ? number : listeners_.beams->number_now(number);
        if (now != kNotBefore) {
            verify_connection(now);
        }
    }
    pop();
    taken_over_ = connected_.size();
}

// Both ends of the leg know where it may run: it lies on the straight line between the images of
// source and listener, which passes both apertures.
void CandidateGenerator::find_connections(const VisibleFacets& search,
                                          const VisibleFacet& visible,
                                          bool only_new) {
    const ListenerBeams& beams = *listeners_.beams;
    if (only_new && !beams.has_new()) {
        return;
    }
    const Plane& plane = index_.plane(visible.facet);
    const Frustum reflected = mirrored(search.frustum(), plane, visible.facet, visible.aperture);
    const double position_error =
        4.0 * kRounding * (index_.extent() + max_radius_ + glm::length(reflected.apex));
    const ConnectingLegs legs(
        reflected, plane, position_error, beams.max_coordinate(), options_.max_length);
    subpaths_.clear();
    only_new ? beams.find_new(legs, subpaths_) : beams.tree().find(legs, subpaths_);
    if (subpaths_.empty()) {
        return;
    }
    push(visible.facet);
    const Vec3 image_source = images_.back();
    for (const std::uint32_t number : subpaths_) {
        const ListenerSubpath& subpath = beams.subpaths()[number];
        if (subpath.first.facet != visible.facet &&
            search.may_pass(visible, plane.mirror(beams.image(number))) &&
            beams.may_arrive_from(
                subpath, image_source, index_.plane(subpath.first.facet).mirror(image_source))) {
            verify_connection(number);
        }
    }
    pop();
}

// Precondition: the sequence ends in the visible facet.
void CandidateGenerator::verify_connection(std::uint32_t number) {
    const ListenerSubpath& subpath = listeners_.beams->subpaths()[number];
    connected_.push_back(number);
    push(subpath.first.facet);
    if (subpath.has_two) {
        push(subpath.last);
    }
    verify_candidate(subpath.listener);
    if (subpath.has_two) {
        pop();
    }
    pop();
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
