// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/listener_beams.h"

#include "earshot/base/assert.h"
#include "earshot/frustum/internal/geometry_change.h"
#include "earshot/frustum/internal/kept_frusta.h"
#include "earshot/frustum/internal/primary_facets.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

namespace {

constexpr std::size_t kFrustaPerListener = 6;
constexpr std::size_t kGrain = 16;

/// A box around a point: floats are off by at most 2^-24 of their size.
geometry::Aabb box_around(const Vec3& point) noexcept {
    geometry::Aabb box;
    for (int k = 0; k < 3; ++k) {
        const auto coordinate = static_cast<float>(point[k]);
        const float error = 0x1p-22F * std::abs(coordinate) + 0x1p-120F;
        box.lower[static_cast<std::size_t>(k)] = coordinate - error;
        box.upper[static_cast<std::size_t>(k)] = coordinate + error;
    }
    return box;
}

/// The distance of a point from a box.
double distance_to(const geometry::Aabb& box, const Vec3& point) noexcept {
    const Vec3 lower = {box.lower[0], box.lower[1], box.lower[2]};
    const Vec3 upper = {box.upper[0], box.upper[1], box.upper[2]};
    return glm::distance(point, glm::clamp(point, lower, upper));
}

}  // namespace

ListenerBeams::ListenerBeams(const FacetIndex& index,
                             double contact_radius,
                             double max_radius,
                             int max_order,
                             std::span<const Vec3> listeners,
                             int subpath_reflections,
                             Executor& executor)
    : index_(index), max_radius_(max_radius) {
    trace(listeners, contact_radius, max_order, subpath_reflections, {}, executor);
}

ListenerBeams::ListenerBeams(const FacetIndex& index,
                             double contact_radius,
                             double max_radius,
                             int max_order,
                             std::span<const Vec3> listeners,
                             int subpath_reflections,
                             const ListenerBeams& before,
                             const GeometryChange& change,
                             Executor& executor)
    : index_(index), max_radius_(max_radius) {
    // Without subpaths nothing is kept but six frusta, whose facets are not told apart.
    const bool keeps_frusta = subpath_reflections > 0;
    trace(listeners,
          contact_radius,
          max_order,
          subpath_reflections,
          keeps_frusta ? Before{&before, &change} : Before{},
          executor);
}

void ListenerBeams::trace(std::span<const Vec3> listeners,
                          double contact_radius,
                          int max_order,
                          int subpath_reflections,
                          const Before& before,
                          Executor& executor) {
    trace_first_beams(listeners, contact_radius, subpath_reflections, before, executor);
    if (subpath_reflections > 1) {
        const std::size_t of_one_reflection = subpaths_.size();
        trace_reflected_beams(contact_radius, before, executor);
        for (std::size_t i = 0; i < of_one_reflection; ++i) {
            const ListenerSubpath subpath = subpaths_[i];
            if (subpath.first.grazing) {
                append_before_grazing(listeners[subpath.listener], subpath, max_order);
            }
        }
    }
    place_images(listeners, before, executor);
}

std::size_t ListenerBeams::kept_frusta() const noexcept {
    return static_cast<std::size_t>(std::count(is_kept_.begin(), is_kept_.end(), 1));
}

std::size_t ListenerBeams::bytes() const noexcept {
    constexpr std::size_t kInTree = sizeof(SubpathBounds) + sizeof(Vec3);
    return frusta_.size() * sizeof(Frustum) + occluders_.size() * sizeof(OccluderDepths) +
           subpaths_.size() * (sizeof(ListenerSubpath) + kInTree) +
           number_now_.size() * sizeof(std::uint32_t) + new_.size() * sizeof(SubpathBounds);
}

std::vector<VisibleFacet> ListenerBeams::visible_in(std::size_t frustum) const {
    std::vector<VisibleFacet> visible;
    for (std::size_t i = first_subpath_[frustum]; i < first_subpath_[frustum + 1]; ++i) {
        visible.push_back(subpaths_[i].first);
    }
    return visible;
}

// The facets that are visible in a frustum, which becomes the current one of the search; whether
// they are those that were visible before the change, in the frustum `old`.
bool ListenerBeams::find_visible(std::size_t frustum,
                                 std::optional<std::size_t> old,
                                 const Before& before,
                                 VisibleFacets& search,
                                 std::vector<VisibleFacet>& visible,
                                 OccluderDepths& occluders) const {
    visible.clear();
    if (old) {
        search.set_frustum(frusta_[frustum]);
        const std::vector<VisibleFacet> visible_before = before.beams->visible_in(*old);
        occluders = before.beams->occluders_of(*old);
        if (are_still_visible(search, visible_before, occluders, *before.change)) {
            append_renumbered(visible_before, *before.change, visible);
            return true;
        }
    }
    search.search(frusta_[frustum]);
    visible = search.found();
    occluders = search.occluder_depths();
    return false;
}

void ListenerBeams::trace_first_beams(std::span<const Vec3> listeners,
                                      double contact_radius,
                                      int subpath_reflections,
                                      const Before& before,
                                      Executor& executor) {
    const double min_depth = 0.5 * kRounding * index_.extent();
    for (const Vec3& listener : listeners) {
        const auto around = frusta_around(listener, 1, kGridSide, min_depth);
        frusta_.insert(frusta_.end(), around.begin(), around.end());
    }
    // Facets visible from each listener, some of a frustum at a time. The frusta around it are as
    // before a change.
    const auto make_search = [&] {
        return VisibleFacets(
            index_, Mode::complete, contact_radius, max_radius_, GrazingFacets::keep);
    };
    const int pieces = subpath_reflections > 1 ? kPrimaryPieces : 1;
    std::vector<std::vector<VisibleFacet>> visible_before;
    for (std::size_t i = 0; before.beams != nullptr && i < frusta_.size(); ++i) {
        visible_before.push_back(before.beams->visible_in(i));
    }
    PrimaryFacets primary =
        before.beams != nullptr
            ? update_primary_facets(
                  frusta_, visible_before, *before.change, pieces, make_search, executor)
            : PrimaryFacets{find_primary_facets(frusta_, pieces, make_search, executor)};
    for (std::size_t i = 0; i < frusta_.size(); ++i) {
        const bool is_known = before.beams != nullptr;
        before_.push_back(is_known ? static_cast<std::uint32_t>(i) : kNotBefore);
        is_kept_.push_back(is_known ? primary.is_kept[i] : 0);
    }
    const auto& visible = primary.visible;
    const std::vector<FacetRange> ranges = divide_facets(visible);
    std::vector<Found> found(ranges.size());
    executor.for_each(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        for (std::size_t i = begin; i < end; ++i) {
            const FacetRange& range = ranges[i];
            const auto listener = static_cast<std::uint32_t>(range.frustum / kFrustaPerListener);
            search.set_frustum(frusta_[range.frustum]);
            for (std::size_t k = range.begin; k < range.end; ++k) {
                const VisibleFacet& facet = visible[range.frustum][k];
                found[i].subpaths.push_back({.first = facet,
                                             .last = facet.facet,
                                             .listener = listener,
                                             .frustum = static_cast<std::uint32_t>(range.frustum)});
                if (subpath_reflections > 1 && !facet.grazing) {
                    found[i].reflected.push_back(search.reflect(facet));
                    found[i].listeners.push_back(listener);
                }
            }
        }
    });
    append_last_reflections(listeners, found);
    if (subpath_reflections == 0) {
        return;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (ranges[i].begin == 0) {
            first_subpath_.push_back(static_cast<std::uint32_t>(subpaths_.size()));
        }
        subpaths_.insert(subpaths_.end(), found[i].subpaths.begin(), found[i].subpaths.end());
        frusta_.insert(frusta_.end(), found[i].reflected.begin(), found[i].reflected.end());
        listener_of_reflected_.insert(
            listener_of_reflected_.end(), found[i].listeners.begin(), found[i].listeners.end());
    }
    first_subpath_.push_back(static_cast<std::uint32_t>(subpaths_.size()));
}

// A facet may be visible in several of a listener's frusta: once per listener.
void ListenerBeams::append_last_reflections(std::span<const Vec3> listeners,
                                            const std::vector<Found>& found) {
    std::vector<VisiblePair> pairs;
    for (const Found& of_range : found) {
        for (const ListenerSubpath& subpath : of_range.subpaths) {
            pairs.push_back({subpath.listener, subpath.last});
        }
    }
    const auto key = [](const VisiblePair& pair) { return std::pair(pair.facet, pair.listener); };
    std::sort(pairs.begin(), pairs.end(), [&](const VisiblePair& a, const VisiblePair& b) {
        return key(a) < key(b);
    });
    const auto last =
        std::unique(pairs.begin(), pairs.end(), [&](const VisiblePair& a, const VisiblePair& b) {
            return key(a) == key(b);
        });
    pairs.erase(last, pairs.end());
    std::vector<PointsByFacet<LastReflection>::Entry> entries;
    for (const auto& [listener, facet] : pairs) {
        entries.push_back({facet, index_.plane(facet).mirror(listeners[listener]), {listener}});
    }
    last_reflections_ = {index_.size(), entries};
}

void ListenerBeams::trace_reflected_beams(double contact_radius,
                                          const Before& before,
                                          Executor& executor) {
    const std::size_t first_reflected = frusta_.size() - listener_of_reflected_.size();
    // One table per listener: two may be in one place.
    std::vector<FrustumLookup> lookups(first_reflected / kFrustaPerListener);
    if (before.beams != nullptr) {
        const std::vector<Frustum>& old = before.beams->frusta_;
        for (std::size_t i = first_reflected; i < old.size(); ++i) {
            const std::uint32_t listener =
                before.beams->listener_of_reflected_[i - first_reflected];
            lookups[listener].add(old[i], i, *before.change);
        }
        for (FrustumLookup& lookup : lookups) {
            lookup.finish();
        }
    }
    struct Chunk {
        std::vector<VisibleFacet> visible;
        std::vector<std::size_t> ends;  // per frustum, into `visible`
    };
    before_.resize(frusta_.size(), kNotBefore);
    is_kept_.resize(frusta_.size(), 0);
    occluders_.resize(listener_of_reflected_.size());
    std::vector<Chunk> chunks(chunk_count(listener_of_reflected_.size(), kGrain));
    executor.for_each(
        listener_of_reflected_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            Chunk& chunk = chunks[begin / kGrain];
            VisibleFacets search(
                index_, Mode::complete, contact_radius, max_radius_, GrazingFacets::keep);
            std::vector<VisibleFacet> visible;
            for (std::size_t i = first_reflected + begin; i < first_reflected + end; ++i) {
                const std::uint32_t listener = listener_of_reflected_[i - first_reflected];
                const auto old = lookups[listener].find(frusta_[i]);
                before_[i] = old ? static_cast<std::uint32_t>(*old) : kNotBefore;
                is_kept_[i] =
                    find_visible(i, old, before, search, visible, occluders_[i - first_reflected])
                        ? 1
                        : 0;
                chunk.visible.insert(chunk.visible.end(), visible.begin(), visible.end());
                chunk.ends.push_back(chunk.visible.size());
            }
        });
    // Where the subpaths of each chunk and frustum go, then the subpaths.
    std::vector<std::size_t> first_of_chunk;
    std::size_t count = subpaths_.size();
    for (const Chunk& chunk : chunks) {
        first_of_chunk.push_back(count);
        for (const std::size_t end : chunk.ends) {
            first_subpath_.push_back(static_cast<std::uint32_t>(count + end));
        }
        count += chunk.visible.size();
    }
    subpaths_.resize(count);
    executor.for_each(chunks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            std::size_t reflected = kGrain * i;
            std::size_t begin = 0;
            for (const std::size_t end : chunks[i].ends) {
                for (; begin < end; ++begin) {
                    subpaths_[first_of_chunk[i] + begin] = {
                        .first = chunks[i].visible[begin],
                        .last = frusta_[first_reflected + reflected].facet,
                        .listener = listener_of_reflected_[reflected],
                        .frustum = static_cast<std::uint32_t>(first_reflected + reflected),
                        .has_two = true};
                }
                ++reflected;
            }
        }
    });
}

// No frustum is mirrored in a facet in whose plane the listener lies. The path comes to the
// listener from a point p of that facet, and to p from a point q. Unfolded, the listener, p and q
// lie on a straight line that crosses the plane in p: q is |q - p| / |listener - p| times as high
// above it as the listener. So if the listener is not at the facet, q lies hardly above the plane,
// and only facets that come as close to it may be the last but one.
void ListenerBeams::append_before_grazing(const Vec3& listener,
                                          const ListenerSubpath& grazing,
                                          int max_order) {
    constexpr double kSafety = 8.0;
    const Plane& plane = index_.plane(grazing.last);
    // Image sources lie no farther away than every reflection can move them.
    const double distances =
        index_.extent() + 2.0 * max_radius_ + 4.0 * (max_order + 1) * index_.extent();
    const double error = kSafety * kRounding * distances;
    const double distance = distance_to(index_.box(grazing.last), listener) - error;
    const double diameter = 4.0 * index_.extent();
    const double reach = distance > error ? kSafety * (std::abs(plane.distance(listener)) + error) *
                                                    (1.0 + diameter / distance) +
                                                error
                                          : std::numeric_limits<double>::infinity();
    for (FacetId facet = 0; facet < index_.size(); ++facet) {
        const auto loops = index_.loops(facet);
        if (facet == grazing.last || loops.empty()) {
            continue;
        }
        double lowest = std::numeric_limits<double>::infinity();
        double highest = -lowest;
        for (std::uint32_t v = loops.front().begin; v < loops.back().end; ++v) {
            const double height = plane.distance(index_.vertices()[v]);
            lowest = std::min(lowest, height);
            highest = std::max(highest, height);
        }
        const double slack = reach + 4.0 * index_.flatness(facet);
        if (lowest <= slack && highest >= -slack) {
            ListenerSubpath subpath = grazing;
            subpath.first.facet = facet;
            subpath.has_two = true;
            subpaths_.push_back(subpath);
        }
    }
}

// Per subpath its number before the change, or kNotBefore. A frustum that was kept has the same
// subpaths in the same order, another one some of them.
std::vector<std::uint32_t> ListenerBeams::subpaths_before(const Before& before) const {
    std::vector<std::uint32_t> numbers(subpaths_.size(), kNotBefore);
    std::vector<std::uint32_t> positions;
    for (std::size_t i = 0; before.beams != nullptr && i < before_.size(); ++i) {
        if (before_[i] == kNotBefore) {
            continue;
        }
        const std::uint32_t begin = first_subpath_[i];
        const std::uint32_t count = first_subpath_[i + 1] - begin;
        const std::uint32_t begin_before = before.beams->first_subpath_[before_[i]];
        if (is_kept_[i] != 0) {
            std::iota(numbers.begin() + begin, numbers.begin() + begin + count, begin_before);
            continue;
        }
        positions.clear();
        append_positions_before(
            visible_in(i), before.beams->visible_in(before_[i]), *before.change, positions);
        for (std::uint32_t k = 0; k < count; ++k) {
            numbers[begin + k] =
                positions[k] != kNotBefore ? begin_before + positions[k] : kNotBefore;
        }
    }
    return numbers;
}

// The subpaths that there were in the order of the tree before, then the others in an order of
// their own, which also have a tree to themselves.
void ListenerBeams::plant_trees(std::span<const std::uint32_t> number_before,
                                const ListenerBeams* before,
                                Executor& executor) {
    if (before == nullptr) {
        tree_ = SubpathTree(bounds_, executor);
        return;
    }
    number_now_.assign(before->subpaths_.size(), kNotBefore);
    std::vector<SubpathBounds> bounds_of_new;
    for (std::uint32_t i = 0; i < number_before.size(); ++i) {
        if (number_before[i] != kNotBefore) {
            number_now_[number_before[i]] = i;
        } else {
            new_.push_back(i);
            bounds_of_new.push_back(bounds_[i]);
        }
    }
    tree_of_new_ = SubpathTree(bounds_of_new, executor);
    std::vector<std::uint32_t> order;
    order.reserve(number_before.size());
    for (const std::uint32_t number : before->tree_.numbers()) {
        if (number_now_[number] != kNotBefore) {
            order.push_back(number_now_[number]);
        }
    }
    for (const std::uint32_t place : tree_of_new_.numbers()) {
        order.push_back(new_[place]);
    }
    EARSHOT_ASSERT(order.size() == subpaths_.size());
    tree_ = SubpathTree(bounds_, std::move(order), executor);
}

void ListenerBeams::find_new(const ConnectingLegs& legs, std::vector<std::uint32_t>& found) const {
    const std::size_t first = found.size();
    tree_of_new_.find(legs, found);
    for (std::size_t i = first; i < found.size(); ++i) {
        found[i] = new_[found[i]];
    }
}

void ListenerBeams::place_images(std::span<const Vec3> listeners,
                                 const Before& before,
                                 Executor& executor) {
    images_.resize(subpaths_.size());
    bounds_.resize(subpaths_.size());
    const std::vector<std::uint32_t> number_before = subpaths_before(before);
    constexpr std::size_t kImageGrain = 1024;
    executor.for_each(subpaths_.size(), kImageGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (number_before[i] != kNotBefore) {
                images_[i] = before.beams->images_[number_before[i]];
                bounds_[i] = before.beams->bounds_[number_before[i]];
                continue;
            }
            const ListenerSubpath& subpath = subpaths_[i];
            // Where a frustum starts at a facet, that is the last one.
            const Frustum& frustum = frusta_[subpath.frustum];
            Vec3 image = frustum.starts_at_facet
                             ? frustum.apex
                             : index_.plane(subpath.last).mirror(listeners[subpath.listener]);
            if (subpath.has_two) {
                image = index_.plane(subpath.first.facet).mirror(image);
            }
            bounds_[i].aperture = aperture_box(subpath);
            bounds_[i].image = box_around(image);
            images_[i] = image;
        }
    });
    plant_trees(number_before, before.beams, executor);
}

// A box around the points of the first facet that lie in its aperture. It is the box of the facet
// or, where the rays through the corners of the aperture meet the facet's plane, a smaller one.
geometry::Aabb ListenerBeams::aperture_box(const ListenerSubpath& subpath) const {
    const geometry::Aabb& whole = index_.box(subpath.first.facet);
    const auto is_large = [&](const geometry::Aabb& box) {
        constexpr double kSmall = 1.0 / 32.0;  // of the scene: hardly worth a smaller box
        double size = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            size = std::max(size, static_cast<double>(box.upper[k] - box.lower[k]));
        }
        return size > kSmall * index_.extent();
    };
    if (subpath.first.grazing || !is_large(whole)) {
        return whole;
    }
    const Frustum& frustum = frusta_[subpath.frustum];
    const Plane& plane = index_.plane(subpath.first.facet);
    const InverseDepth inverse_depth = frustum.inverse_depth(plane);
    const double position_error =
        4.0 * kRounding * (index_.extent() + max_radius_ + glm::length(frustum.apex));
    const double depth_error = position_error / std::abs(plane.distance(frustum.apex));
    const Rect& aperture = subpath.first.aperture;
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    for (const double u : {aperture.lower.x, aperture.upper.x}) {
        for (const double v : {aperture.lower.y, aperture.upper.y}) {
            const double inverse = inverse_depth.at({u, v});
            constexpr double kMaxDiameters = 4.0;  // no point of the scene is farther away
            if (!(kMaxDiameters * (index_.extent() + glm::length(frustum.apex)) * inverse > 1.0)) {
                return whole;
            }
            const double depth = 1.0 / inverse;
            const Vec3 point =
                frustum.apex + depth * (frustum.forward + u * frustum.right + v * frustum.up);
            const double slack = 4.0 * (position_error + depth * depth_error);
            lower = glm::min(lower, point - slack);
            upper = glm::max(upper, point + slack);
        }
    }
    geometry::Aabb box = box_around(lower);
    box.include(box_around(upper));
    for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k] = std::max(box.lower[k], whole.lower[k]);
        box.upper[k] = std::min(box.upper[k], whole.upper[k]);
    }
    return box.lower[0] <= box.upper[0] && box.lower[1] <= box.upper[1] &&
                   box.lower[2] <= box.upper[2]
               ? box
               : whole;
}

bool ListenerBeams::may_arrive_from(const ListenerSubpath& subpath,
                                    const Vec3& image_source,
                                    const Vec3& folded) const noexcept {
    if (subpath.first.grazing) {
        return true;
    }
    const Frustum& frustum = frusta_[subpath.frustum];
    const double position_error =
        4.0 * kRounding *
        (index_.extent() + max_radius_ + glm::length(frustum.apex) + glm::length(image_source));
    const Plane& plane = index_.plane(subpath.first.facet);
    const double height = plane.distance(image_source);
    const bool is_beyond =
        plane.distance(frustum.apex) > 0.0 ? height < -position_error : height > position_error;
    return !is_beyond && may_pass(frustum, subpath.first, folded, position_error);
}

}  // namespace earshot::frustum
