// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/listener_side.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

constexpr std::size_t kRoots = 6;
constexpr std::size_t kGrain = 16;

}  // namespace

template <typename Item>
PerFacet<Item>::PerFacet(std::size_t facets, std::span<const Entry> entries) {
    std::vector<std::uint32_t> counts(facets, 0);
    for (const Entry& entry : entries) {
        ++counts[entry.facet];
    }
    first_.assign(facets + 1, 0);
    for (std::size_t i = 0; i < facets; ++i) {
        first_[i + 1] = first_[i] + static_cast<std::uint32_t>(chunk_count(counts[i], kWidth));
    }
    PointBlock empty;
    for (auto& coordinates : empty.coordinate) {
        std::fill(std::begin(coordinates),
                  std::end(coordinates),
                  std::numeric_limits<double>::quiet_NaN());
    }
    points_.assign(first_.back(), empty);
    items_.resize(kWidth * points_.size());
    std::fill(counts.begin(), counts.end(), 0);
    for (const Entry& entry : entries) {
        const std::size_t place = kWidth * first_[entry.facet] + counts[entry.facet]++;
        items_[place] = entry.item;
        for (int k = 0; k < 3; ++k) {
            points_[place / kWidth].coordinate[k][place % kWidth] = entry.point[k];
        }
    }
}

ListenerSide::ListenerSide(const FacetIndex& index,
                           double contact_reach,
                           double reach,
                           std::span<const Vec3> listeners,
                           bool with_pairs,
                           Executor& executor)
    : index_(index), reach_(reach) {
    look_around(listeners, contact_reach, executor);
    if (with_pairs) {
        look_into_facets(listeners, contact_reach, executor);
    } else {
        pairs_ = {index.size(), {}};
    }
}

void ListenerSide::look_around(std::span<const Vec3> listeners,
                               double contact_reach,
                               Executor& executor) {
    struct Found {
        std::vector<Seen> seen;
        std::vector<Grazed> grazed;
        std::vector<Mirrored> frusta;
    };
    std::vector<Found> of_root(kRoots * listeners.size());
    executor.for_each(of_root.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search(index_, Mode::complete, contact_reach, reach_, Grazing::keep);
        for (std::size_t i = begin; i < end; ++i) {
            const auto listener = static_cast<std::uint32_t>(i / kRoots);
            const double least_depth = 0.5 * kRounding * index_.scale();
            const auto roots = frusta_around(listeners[listener], 1, kGridSide, least_depth);
            search.search(roots[i % kRoots]);
            for (const VisibleFacet& visible : search.found()) {
                of_root[i].seen.push_back({listener, visible.facet});
                if (visible.grazes) {
                    of_root[i].grazed.push_back({visible.facet, listener});
                } else {
                    of_root[i].frusta.push_back({listener, search.reflect(visible)});
                }
            }
        }
    });
    std::vector<Seen> seen;
    for (const Found& found : of_root) {
        seen.insert(seen.end(), found.seen.begin(), found.seen.end());
        grazed_.insert(grazed_.end(), found.grazed.begin(), found.grazed.end());
        frusta_.insert(frusta_.end(), found.frusta.begin(), found.frusta.end());
    }
    // A facet may be seen in several roots.
    const auto before = [](const auto& a, const auto& b) {
        return std::pair(a.facet, a.listener) < std::pair(b.facet, b.listener);
    };
    const auto same = [](const auto& a, const auto& b) {
        return a.facet == b.facet && a.listener == b.listener;
    };
    const auto unify = [&](auto& items) {
        std::sort(items.begin(), items.end(), before);
        items.erase(std::unique(items.begin(), items.end(), same), items.end());
    };
    unify(seen);
    unify(grazed_);
    std::vector<PerFacet<LastFacet>::Entry> entries;
    for (const auto& [listener, facet] : seen) {
        entries.push_back({facet, index_.plane(facet).mirror(listeners[listener]), {listener}});
    }
    last_ = {index_.size(), entries};
}

void ListenerSide::look_into_facets(std::span<const Vec3> listeners,
                                    double contact_reach,
                                    Executor& executor) {
    using Entry = PerFacet<LastPair>::Entry;
    std::vector<std::vector<Entry>> of_chunk(chunk_count(frusta_.size(), kGrain));
    executor.for_each(frusta_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search(index_, Mode::complete, contact_reach, reach_, Grazing::keep);
        for (std::size_t i = begin; i < end; ++i) {
            const auto& [listener, frustum] = frusta_[i];
            search.search(frustum);
            const Vec3 image = index_.plane(frustum.facet).mirror(listeners[listener]);
            for (const VisibleFacet& visible : search.found()) {
                of_chunk[begin / kGrain].push_back({visible.facet,
                                                    index_.plane(visible.facet).mirror(image),
                                                    {.last = frustum.facet,
                                                     .listener = listener,
                                                     .frustum = static_cast<std::uint32_t>(i),
                                                     .window = visible.window,
                                                     .grazes = visible.grazes}});
            }
        }
    });
    std::vector<Entry> all;
    for (const auto& entries : of_chunk) {
        all.insert(all.end(), entries.begin(), entries.end());
    }
    pairs_ = {index_.size(), all};
}

bool ListenerSide::may_come_from(const LastPair& pair, const Vec3& image_source) const noexcept {
    if (pair.grazes) {
        return true;
    }
    const Frustum& frustum = frusta_[pair.frustum].frustum;
    const double moved = kRounding * (index_.scale() + reach_ + glm::length(frustum.apex));
    return may_pass_window(frustum, pair.window, image_source, moved);
}

}  // namespace earshot::frustum
