// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/proposer.h"

#include "earshot/frustum/internal/last_reflection.h"

#include <glm/geometric.hpp>

#include <bit>
#include <iterator>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

void Harvest::append(Harvest&& other) {
    std::move(other.paths.begin(), other.paths.end(), std::back_inserter(paths));
    statistics.frusta += other.statistics.frusta;
    statistics.candidates += other.statistics.candidates;
}

Proposer::Proposer(const FacetIndex& index,
                   const PathVerifier& verifier,
                   const Audience& audience,
                   const TraceOptions& options,
                   double reach,
                   const Vec3& source)
    : index_(index),
      verifier_(verifier),
      audience_(audience),
      options_(options),
      reach_(reach),
      images_{source} {}

void Proposer::push(FacetId facet) {
    sequence_.push_back(facet);
    images_.push_back(index_.plane(facet).mirror(images_.back()));
}

void Proposer::pop() {
    sequence_.pop_back();
    images_.pop_back();
}

void Proposer::propose_direct() {
    for (std::size_t i = 0; i < audience_.listeners.size(); ++i) {
        propose(i);
    }
}

// The image says how long the path would be, to the last bit.
void Proposer::propose(std::size_t listener) {
    const Vec3& to = audience_.listeners[listener];
    if (!is_wanted(glm::distance(images_.back(), to))) {
        return;
    }
    ++harvest_.statistics.candidates;
    auto path = verifier_.verify(sequence_, images_, to);
    if (path && path->triangles.size() <= static_cast<std::size_t>(options_.max_order)) {
        path->listener = listener;
        harvest_.paths.push_back(std::move(*path));
    }
}

bool Proposer::is_wanted(double length) const noexcept {
    double factor = 1.0;
    if (options_.min_pressure > 0.0) {
        for (const FacetId facet : sequence_) {
            factor *= index_.max_pressure_factor(facet);
        }
    }
    return length <= options_.max_length && !(factor < options_.min_pressure * length);
}

void Proposer::propose_from(const VisibleFacets& search, std::span<const VisibleFacet> seen) {
    if (audience_.side == nullptr) {
        look_for_listeners(search, seen);
        return;
    }
    sight_ = search.sight();
    const auto next_order = static_cast<int>(order()) + 1;
    for (const VisibleFacet& visible : seen) {
        meet_listeners(search, visible);
        if (next_order + 1 == options_.max_order) {
            meet_pairs(search, visible);
            meet_grazed(search, visible);
        }
    }
}

template <typename Item, typename Meet>
void Proposer::for_each_in_sight(const VisibleFacets& search,
                                 const VisibleFacet& visible,
                                 const PerFacet<Item>& kept,
                                 Meet&& meet) {
    const auto points = kept.points(visible.facet);
    if (points.empty()) {
        return;
    }
    for (int k = 0; k < 2; ++k) {
        sight_.lower[k] = visible.window.lower[k];
        sight_.upper[k] = visible.window.upper[k];
    }
    in_sight_.resize(points.size());
    find_in_sight(sight_, points, in_sight_);
    const auto items = kept.items(visible.facet);
    for (std::size_t block = 0; block < points.size(); ++block) {
        for (std::uint32_t left = in_sight_[block]; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            const auto& coordinate = points[block].coordinate;
            const Vec3 point = {coordinate[0][lane], coordinate[1][lane], coordinate[2][lane]};
            if (search.may_pass(visible, point)) {
                meet(items[PointBlock::kWidth * block + lane]);
            }
        }
    }
}

// Sound goes from the facet straight to a listener who sees it.
void Proposer::meet_listeners(const VisibleFacets& search, const VisibleFacet& visible) {
    for_each_in_sight(search, visible, audience_.side->last(), [&](const LastFacet& last) {
        if (search.may_reach_mirrored(visible, audience_.listeners[last.listener])) {
            push(visible.facet);
            propose(last.listener);
            pop();
        }
    });
}

// Sound goes on by one more facet, in which the listener sees this one.
void Proposer::meet_pairs(const VisibleFacets& search, const VisibleFacet& visible) {
    const ListenerSide& side = *audience_.side;
    for_each_in_sight(search, visible, side.pairs(), [&](const LastPair& pair) {
        push(visible.facet);
        if (side.may_come_from(pair, images_.back())) {
            push(pair.last);
            propose(pair.listener);
            pop();
        }
        pop();
    });
}

void Proposer::meet_grazed(const VisibleFacets& search, const VisibleFacet& visible) {
    const auto grazed = audience_.side->grazed();
    if (grazed.empty()) {
        return;
    }
    const Frustum& parent = search.frustum();
    const Frustum child =
        mirrored(parent, index_.plane(visible.facet), visible.facet, visible.window);
    const double moved = 4.0 * kRounding * (index_.scale() + reach_ + glm::length(child.apex));
    for (const ListenerSide::Grazed& last : grazed) {
        const Vec3& listener = audience_.listeners[last.listener];
        if (last.facet != visible.facet &&
            may_reflect_last(index_, child, last.facet, listener, moved)) {
            push(visible.facet);
            push(last.facet);
            propose(last.listener);
            pop();
            pop();
        }
    }
}

// Without a listeners' side: listeners in the frustum itself, and in those that would come after
// the last one.
void Proposer::look_for_listeners(const VisibleFacets& search, std::span<const VisibleFacet> seen) {
    const Frustum& frustum = search.frustum();
    const double moved = 4.0 * kRounding * (index_.scale() + reach_ + glm::length(frustum.apex));
    const auto in_frustum = [&](const Frustum& place, auto&& may_reach) {
        const BoxCull cull(
            place, place.starts_at_facet ? &index_.plane(place.facet) : nullptr, moved);
        audience_.points->visit_in(cull, [&](std::uint32_t listener) {
            if (may_reach(audience_.listeners[listener])) {
                propose(listener);
            }
        });
    };
    if (order() > 0) {
        in_frustum(frustum, [&](const Vec3& listener) { return search.may_reach(listener); });
    }
    if (static_cast<int>(order()) + 1 < options_.max_order) {
        return;
    }
    for (const VisibleFacet& visible : seen) {
        const Frustum child =
            mirrored(frustum, index_.plane(visible.facet), visible.facet, visible.window);
        push(visible.facet);
        in_frustum(child, [&](const Vec3& listener) {
            return search.may_reach_mirrored(visible, listener);
        });
        pop();
    }
}

}  // namespace earshot::frustum
