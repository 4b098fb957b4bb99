// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/kept_frusta.h"

#include "earshot/frustum/internal/kept_connections.h"
#include "earshot/frustum/internal/primary_facets.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace earshot::frustum {

using geometry::Aabb;

namespace {

bool is_same_aperture(const VisibleFacet& a, const VisibleFacet& b) noexcept {
    return a.aperture == b.aperture && a.cells == b.cells && a.grazing == b.grazing;
}

}  // namespace

bool are_still_visible(const VisibleFacets& search,
                       std::span<const VisibleFacet> visible_before,
                       const OccluderDepths& occluders,
                       const GeometryChange& change) {
    const bool are_unchanged =
        std::all_of(visible_before.begin(), visible_before.end(), [&](const VisibleFacet& visible) {
            return change.after(visible.facet) != GeometryChange::kChanged;
        });
    if (!are_unchanged) {
        return false;
    }
    const BoxCull cull = search.box_cull();
    return !change.any_swept_box(
        [&](const Aabb& box) { return cull.may_overlap(box); },
        [&](const Aabb& box) { return search.may_overlap(box, occluders); });
}

void append_renumbered(std::span<const VisibleFacet> visible_before,
                       const GeometryChange& change,
                       std::vector<VisibleFacet>& visible) {
    for (const VisibleFacet& before : visible_before) {
        visible.push_back(before);
        visible.back().facet = change.after(before.facet);
    }
}

void append_positions_before(std::span<const VisibleFacet> visible,
                             std::span<const VisibleFacet> visible_before,
                             const GeometryChange& change,
                             std::vector<std::uint32_t>& positions) {
    // A facet is visible in a frustum once.
    std::vector<std::pair<geometry::FacetId, std::uint32_t>> unchanged;  // by the number of now
    for (std::uint32_t i = 0; i < visible_before.size(); ++i) {
        const geometry::FacetId facet = change.after(visible_before[i].facet);
        if (facet != GeometryChange::kChanged) {
            unchanged.emplace_back(facet, i);
        }
    }
    std::sort(unchanged.begin(), unchanged.end());
    for (const VisibleFacet& now : visible) {
        const auto known =
            std::partition_point(unchanged.begin(), unchanged.end(), [&](const auto& other) {
                return other.first < now.facet;
            });
        const bool is_known = known != unchanged.end() && known->first == now.facet &&
                              is_same_aperture(visible_before[known->second], now);
        positions.push_back(is_known ? known->second : kNotBefore);
    }
}

std::size_t PrimaryFacets::kept_frusta() const noexcept {
    return static_cast<std::size_t>(std::count(is_kept.begin(), is_kept.end(), 1));
}

PrimaryFacets update_primary_facets(std::span<const Frustum> frusta,
                                    std::span<const std::vector<VisibleFacet>> visible_before,
                                    const GeometryChange& change,
                                    int pieces,
                                    const std::function<VisibleFacets()>& make_search,
                                    Executor& executor) {
    PrimaryFacets result;
    result.visible.resize(frusta.size());
    result.is_kept.resize(frusta.size(), 0);
    std::vector<Frustum> concerned;
    std::vector<std::size_t> numbers;
    VisibleFacets search = make_search();
    for (std::size_t i = 0; i < frusta.size(); ++i) {
        search.set_frustum(frusta[i]);
        if (are_still_visible(search, visible_before[i], {}, change)) {
            append_renumbered(visible_before[i], change, result.visible[i]);
            result.is_kept[i] = 1;
        } else {
            concerned.push_back(frusta[i]);
            numbers.push_back(i);
        }
    }
    auto found = find_primary_facets(concerned, pieces, make_search, executor);
    for (std::size_t i = 0; i < found.size(); ++i) {
        result.visible[numbers[i]] = std::move(found[i]);
    }
    return result;
}

void FrustumLookup::add(const Frustum& before, std::size_t number, const GeometryChange& change) {
    const geometry::FacetId facet = change.after(before.facet);
    if (facet != GeometryChange::kChanged) {
        entries_.push_back({before, number});
        entries_.back().frustum.facet = facet;
    }
}

void FrustumLookup::finish() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.frustum.facet, a.number) < std::tie(b.frustum.facet, b.number);
    });
}

std::optional<std::size_t> FrustumLookup::find(const Frustum& now) const {
    auto entry = std::partition_point(entries_.begin(), entries_.end(), [&](const Entry& other) {
        return other.frustum.facet < now.facet;
    });
    for (; entry != entries_.end() && entry->frustum.facet == now.facet; ++entry) {
        if (entry->frustum == now) {
            return entry->number;
        }
    }
    return std::nullopt;
}

}  // namespace earshot::frustum
