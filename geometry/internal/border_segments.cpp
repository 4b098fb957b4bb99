// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/border_segments.h"

#include "earshot/geometry/internal/box_tree.h"
#include "earshot/geometry/internal/point_tree.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr std::uint32_t kNone = BorderSegments::kNone;

/// An end of the shorter of two segments in contact lies within the tolerance of the other's line,
/// and projects to within the tolerance of the segment.
constexpr double kReachTolerances = 2.0;

std::uint64_t hash_of(const Vec3& point) noexcept {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        // The sum makes -0 to 0, which it equals.
        hash = mixed_hash(hash, std::bit_cast<std::uint64_t>(point[axis] + 0.0));
    }
    return hash;
}

std::uint32_t add_point(BorderSegments& result, const Vec3& point) {
    const auto next = static_cast<std::uint32_t>(result.points.size());
    const std::uint32_t found = result.point_table.add(
        hash_of(point), next, [&](std::uint32_t i) { return result.points[i] == point; });
    if (found == next) {
        result.points.push_back(point);
    }
    return found;
}

/// Finds the segments of edges between numbered points.
void add_segments(BorderSegments& result,
                  std::span<const std::array<std::uint32_t, 2>> ends_of_edge) {
    FirstIndexTable table(ends_of_edge.size());
    result.segment_of_edge.reserve(ends_of_edge.size());
    for (std::array<std::uint32_t, 2> ends : ends_of_edge) {
        if (lexicographic_less(result.points[ends[1]], result.points[ends[0]])) {
            std::swap(ends[0], ends[1]);
        }
        const auto next = static_cast<std::uint32_t>(result.segments.size());
        const std::uint32_t found =
            table.add(mixed_hash(mixed_hash(0, ends[0]), ends[1]), next, [&](std::uint32_t i) {
                return result.segments[i].ends == ends;
            });
        if (found == next) {
            const Vec3 along = result.points[ends[1]] - result.points[ends[0]];
            result.segments.push_back({ends, glm::dot(along, along), normalized(along)});
        }
        result.segment_of_edge.push_back(found);
    }
}

void list_segments_at_points(BorderSegments& result) {
    result.first_at_point.assign(result.points.size() + 1, 0);
    for (const BorderSegment& segment : result.segments) {
        ++result.first_at_point[segment.ends[0] + 1];
        ++result.first_at_point[segment.ends[1] + 1];
    }
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        result.first_at_point[i + 1] += result.first_at_point[i];
    }
    std::vector<std::uint32_t> next(result.first_at_point.begin(), result.first_at_point.end() - 1);
    result.segments_at_point.resize(2 * result.segments.size());
    for (std::size_t i = 0; i < result.segments.size(); ++i) {
        for (const std::uint32_t point : result.segments[i].ends) {
            result.segments_at_point[next[point]++] = static_cast<std::uint32_t>(i);
        }
    }
}

/// Per segment its number before.
std::vector<std::uint32_t> numbers_before(const BorderSegments& now, const BorderSegments& before) {
    std::vector<std::uint32_t> points(now.points.size(), kNone);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = before.point_table.find(hash_of(now.points[i]), [&](std::uint32_t k) {
            return before.points[k] == now.points[i];
        });
    }
    std::vector<std::uint32_t> numbers(now.segments.size(), kNone);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::uint32_t first = points[now.segments[i].ends[0]];
        const std::uint32_t second = points[now.segments[i].ends[1]];
        if (first == kNone || second == kNone) {
            continue;
        }
        for (const std::uint32_t segment : before.at_point(first)) {
            if (before.segments[segment].ends == std::array{first, second}) {
                numbers[i] = segment;
            }
        }
    }
    return numbers;
}

/// Finds contacts that were not known before.
class ContactSearch {
public:
    explicit ContactSearch(BorderSegments& result)
        : result_(result), reach_(kReachTolerances * result.tolerance) {}

    void run();

private:
    bool is_new(std::uint32_t segment) const noexcept { return result_.before[segment] == kNone; }
    Box box_of(const BorderSegment& segment) const noexcept {
        const Vec3& a = result_.points[segment.ends[0]];
        const Vec3& b = result_.points[segment.ends[1]];
        return {glm::min(a, b) - reach_, glm::max(a, b) + reach_};
    }
    PointTree tree_of(const std::vector<std::uint8_t>& is_chosen) const;
    bool is_longer(std::uint32_t a, std::uint32_t b) const noexcept;
    bool is_in_contact(const BorderSegment& longer, const BorderSegment& shorter) const noexcept;
    void find_shorter(std::uint32_t longer, const PointTree& ends, bool new_only);

    BorderSegments& result_;
    double reach_ = 0.0;
    std::vector<std::uint32_t> last_longer_;  // per segment: the last that it was compared with
};

// Near new segments all ends count, near old ones only those of new segments.
void ContactSearch::run() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto count = static_cast<std::uint32_t>(result_.segments.size());
    Box region{Vec3(kInfinity), Vec3(-kInfinity)};
    std::vector<std::uint8_t> is_end_of_new(result_.points.size(), 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (is_new(i)) {
            const Box box = box_of(result_.segments[i]);
            region = {glm::min(region.lower, box.lower), glm::max(region.upper, box.upper)};
            is_end_of_new[result_.segments[i].ends[0]] = 1;
            is_end_of_new[result_.segments[i].ends[1]] = 1;
        }
    }
    std::vector<std::uint8_t> is_in_region(result_.points.size(), 0);
    for (std::size_t i = 0; i < result_.points.size(); ++i) {
        is_in_region[i] = region.overlaps({result_.points[i], result_.points[i]}) ? 1 : 0;
    }
    const PointTree all = tree_of(is_in_region);
    const PointTree of_new = tree_of(is_end_of_new);
    last_longer_.assign(count, kNone);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (is_new(i)) {
            find_shorter(i, all, false);
        } else if (region.overlaps(box_of(result_.segments[i]))) {
            find_shorter(i, of_new, true);
        }
    }
}

PointTree ContactSearch::tree_of(const std::vector<std::uint8_t>& is_chosen) const {
    std::vector<PointTree::Point> points;
    for (std::size_t i = 0; i < is_chosen.size(); ++i) {
        if (is_chosen[i] != 0) {
            points.push_back({result_.points[i], static_cast<VertexId>(i)});
        }
    }
    return PointTree(std::move(points));
}

bool ContactSearch::is_longer(std::uint32_t a, std::uint32_t b) const noexcept {
    const BorderSegment& first = result_.segments[a];
    const BorderSegment& second = result_.segments[b];
    if (first.squared_length != second.squared_length) {
        return first.squared_length > second.squared_length;
    }
    const auto end = [&](const BorderSegment& segment, std::size_t i) -> const Vec3& {
        return result_.points[segment.ends[i]];
    };
    return first.ends[0] != second.ends[0] ? lexicographic_less(end(first, 0), end(second, 0))
                                           : lexicographic_less(end(first, 1), end(second, 1));
}

bool ContactSearch::is_in_contact(const BorderSegment& longer,
                                  const BorderSegment& shorter) const noexcept {
    const double tolerance = result_.tolerance;
    const double length = std::sqrt(longer.squared_length);
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const std::uint32_t point : shorter.ends) {
        const Vec3 offset = result_.points[point] - result_.points[longer.ends[0]];
        const double z = glm::dot(offset, longer.direction);
        const Vec3 across = offset - z * longer.direction;
        if (!(std::sqrt(glm::dot(across, across)) <= tolerance)) {
            return false;
        }
        low = std::min(low, z);
        high = std::max(high, z);
    }
    return low <= length + tolerance && high >= -tolerance;
}

void ContactSearch::find_shorter(std::uint32_t longer, const PointTree& ends, bool new_only) {
    const BorderSegment& segment = result_.segments[longer];
    const Box box = box_of(segment);
    const Segment line{result_.points[segment.ends[0]], result_.points[segment.ends[1]]};
    ends.near_segment(line, reach_, [&](const PointTree::Point& point) {
        if (!box.overlaps({point.position, point.position})) {
            return;
        }
        for (const std::uint32_t other : result_.at_point(point.vertex)) {
            if (other == longer || last_longer_[other] == longer || (new_only && !is_new(other))) {
                continue;
            }
            last_longer_[other] = longer;
            if (is_longer(longer, other) && is_in_contact(segment, result_.segments[other])) {
                result_.contacts.push_back({longer, other});
            }
        }
    });
}

void add_known_contacts(BorderSegments& result, const BorderSegments& before) {
    std::vector<std::uint32_t> after(before.segments.size(), kNone);
    for (std::size_t i = 0; i < result.before.size(); ++i) {
        if (result.before[i] != kNone) {
            after[result.before[i]] = static_cast<std::uint32_t>(i);
        }
    }
    for (const BorderSegments::Contact& contact : before.contacts) {
        if (after[contact[0]] != kNone && after[contact[1]] != kNone) {
            result.contacts.push_back({after[contact[0]], after[contact[1]]});
        }
    }
    result.known_contacts = result.contacts.size();
}

/// Adds the edges of all facets, with their points, and tells the ends of each edge.
std::vector<std::array<std::uint32_t, 2>> add_edges(BorderSegments& result,
                                                    const Facets& facets,
                                                    std::span<const std::uint8_t> excluded) {
    std::size_t count = 0;
    for (const Facet& facet : facets.facets) {
        for (const Loop& loop : facet.loops) {
            count += loop.size();
        }
    }
    std::vector<std::array<std::uint32_t, 2>> ends_of_edge;
    ends_of_edge.reserve(count);
    result.edges.reserve(count);
    result.point_table = FirstIndexTable(count);
    result.first_of_facet.assign(1, 0);
    for (std::size_t i = 0; i < facets.facets.size(); ++i) {
        const bool is_excluded = !excluded.empty() && excluded[i] != 0;
        for (const Loop& loop : facets.facets[i].loops) {
            if (is_excluded || loop.empty()) {
                continue;
            }
            const std::uint32_t first = add_point(result, loop.front());
            std::uint32_t from = first;
            for (std::size_t k = 0; k < loop.size(); ++k) {
                const bool is_last = k + 1 == loop.size();
                const Vec3& end = loop[is_last ? 0 : k + 1];
                const std::uint32_t to = is_last ? first : add_point(result, end);
                result.edges.push_back({loop[k], end, static_cast<FacetId>(i)});
                ends_of_edge.push_back({from, to});
                from = to;
            }
        }
        result.first_of_facet.push_back(static_cast<std::uint32_t>(result.edges.size()));
    }
    return ends_of_edge;
}

}  // namespace

BorderSegments find_border_segments(const Facets& facets,
                                    std::span<const std::uint8_t> excluded,
                                    double tolerance,
                                    const BorderSegments& before) {
    BorderSegments result;
    result.tolerance = tolerance;
    add_segments(result, add_edges(result, facets, excluded));
    list_segments_at_points(result);
    if (before.tolerance == tolerance) {
        result.before = numbers_before(result, before);
        add_known_contacts(result, before);
    } else {
        result.before.assign(result.segments.size(), kNone);
    }
    ContactSearch(result).run();
    return result;
}

}  // namespace earshot::geometry
