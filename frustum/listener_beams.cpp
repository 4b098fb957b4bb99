// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/listener_beams.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

constexpr std::size_t kFrustaPerListener = 6;
constexpr std::size_t kGrain = 16;

/// Sorts items by facet, then listener, and leaves one of equals.
template <typename Item>
void sort_and_deduplicate(std::vector<Item>& items) {
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return std::pair(a.facet, a.listener) < std::pair(b.facet, b.listener);
    });
    const auto last = std::unique(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return a.facet == b.facet && a.listener == b.listener;
    });
    items.erase(last, items.end());
}

}  // namespace

ListenerBeams::ListenerBeams(const FacetIndex& index,
                             double contact_radius,
                             double max_radius,
                             std::span<const Vec3> listeners,
                             bool two_reflections,
                             Executor& executor)
    : index_(index), max_radius_(max_radius) {
    trace_first_beams(listeners, contact_radius, executor);
    if (two_reflections) {
        trace_reflected_beams(listeners, contact_radius, executor);
    } else {
        last_two_reflections_ = {index.size(), {}};
    }
}

void ListenerBeams::trace_first_beams(std::span<const Vec3> listeners,
                                      double contact_radius,
                                      Executor& executor) {
    struct Found {
        std::vector<VisiblePair> visible;
        std::vector<GrazingFacet> grazing;
        std::vector<ReflectedBeam> beams;
    };
    // Facets visible from each listener, frustum by frustum.
    std::vector<Found> found(kFrustaPerListener * listeners.size());
    executor.for_each(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search(
            index_, Mode::complete, contact_radius, max_radius_, GrazingFacets::keep);
        for (std::size_t i = begin; i < end; ++i) {
            const auto listener = static_cast<std::uint32_t>(i / kFrustaPerListener);
            const double min_depth = 0.5 * kRounding * index_.extent();
            const auto frusta = frusta_around(listeners[listener], 1, kGridSide, min_depth);
            search.search(frusta[i % kFrustaPerListener]);
            for (const VisibleFacet& visible : search.found()) {
                found[i].visible.push_back({listener, visible.facet});
                if (visible.grazing) {
                    found[i].grazing.push_back({visible.facet, listener});
                } else {
                    found[i].beams.push_back({listener, search.reflect(visible)});
                }
            }
        }
    });
    // Joined in the order of the frusta; a facet may be visible in several of a listener's.
    std::vector<VisiblePair> pairs;
    for (const Found& of_frustum : found) {
        pairs.insert(pairs.end(), of_frustum.visible.begin(), of_frustum.visible.end());
        grazing_facets_.insert(
            grazing_facets_.end(), of_frustum.grazing.begin(), of_frustum.grazing.end());
        beams_.insert(beams_.end(), of_frustum.beams.begin(), of_frustum.beams.end());
    }
    sort_and_deduplicate(pairs);
    sort_and_deduplicate(grazing_facets_);
    std::vector<PointsByFacet<LastReflection>::Entry> entries;
    for (const auto& [listener, facet] : pairs) {
        entries.push_back({facet, index_.plane(facet).mirror(listeners[listener]), {listener}});
    }
    last_reflections_ = {index_.size(), entries};
}

void ListenerBeams::trace_reflected_beams(std::span<const Vec3> listeners,
                                          double contact_radius,
                                          Executor& executor) {
    using Entry = PointsByFacet<LastTwoReflections>::Entry;
    std::vector<std::vector<Entry>> of_chunk(chunk_count(beams_.size(), kGrain));
    executor.for_each(beams_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search(
            index_, Mode::complete, contact_radius, max_radius_, GrazingFacets::keep);
        for (std::size_t i = begin; i < end; ++i) {
            const auto& [listener, frustum] = beams_[i];
            search.search(frustum);
            const Vec3 image = index_.plane(frustum.facet).mirror(listeners[listener]);
            for (const VisibleFacet& visible : search.found()) {
                of_chunk[begin / kGrain].push_back({visible.facet,
                                                    index_.plane(visible.facet).mirror(image),
                                                    {.last = frustum.facet,
                                                     .listener = listener,
                                                     .beam = static_cast<std::uint32_t>(i),
                                                     .aperture = visible.aperture,
                                                     .grazing = visible.grazing}});
            }
        }
    });
    std::vector<Entry> all;
    for (const auto& entries : of_chunk) {
        all.insert(all.end(), entries.begin(), entries.end());
    }
    last_two_reflections_ = {index_.size(), all};
}

bool ListenerBeams::may_arrive_from(const LastTwoReflections& reflections,
                                    const Vec3& image_source) const noexcept {
    if (reflections.grazing) {
        return true;
    }
    const Frustum& frustum = beams_[reflections.beam].frustum;
    const double position_error =
        kRounding * (index_.extent() + max_radius_ + glm::length(frustum.apex));
    return may_pass_aperture(frustum, reflections.aperture, image_source, position_error);
}

}  // namespace earshot::frustum
