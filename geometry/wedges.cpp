// SPDX-License-Identifier: MIT
#include "earshot/geometry/wedges.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/internal/border_lines.h"
#include "earshot/geometry/internal/border_segments.h"
#include "earshot/geometry/internal/box_tree.h"
#include "earshot/geometry/internal/line_wedges.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <utility>

// The topology is that of lines in space, not of a half-edge mesh: edges with three faces, sheets
// whose borders meet others in T-junctions and bodies that merely touch diffract too, and a mesh of
// any kind, open or not manifold, has its wedges without OpenMesh.

namespace earshot::geometry {
namespace {

constexpr std::uint32_t kNone = BorderSegments::kNone;

/// Ends of outline edges lie within the tolerance of where they were meant to be, outlines leave
/// out vertices within another one, and so does the outline that the line is taken from.
constexpr double kLineTolerances = 3.0;

/// What wedges depend on of a facet beside its outline.
struct KnownFacet {
    TriangleId first_triangle = 0;
    Plane plane{};
    double deviation = 0.0;
    bool is_one_sided = false;
    Box box{};
};

/// A line on which outlines run, and its wedges.
struct KnownLine {
    FacetId first_facet = 0;
    Vec3 origin{0.0};
    Vec3 direction{0.0};
    Box box{};
    std::uint32_t group = 0;  // of segments: the connected ones, named by one of them
    std::vector<Wedge> wedges{};
};

/// All that is known of one pose.
struct KnownPose {
    std::vector<KnownFacet> facets{};
    std::vector<FacetId> of_triangle{};
    BorderSegments segments{};
    std::vector<std::uint32_t> group_of_segment{};
    std::vector<KnownLine> lines{};  // in the order of the wedges
    std::size_t kept_lines = 0;
};

std::vector<KnownFacet> known_facets(const Facets& facets, const WedgeOptions& options) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<KnownFacet> known;
    known.reserve(facets.facets.size());
    for (std::size_t i = 0; i < facets.facets.size(); ++i) {
        const Facet& facet = facets.facets[i];
        Box box{Vec3(kInfinity), Vec3(-kInfinity)};
        for (const Loop& loop : facet.loops) {
            for (const Vec3& corner : loop) {
                box.lower = glm::min(box.lower, corner);
                box.upper = glm::max(box.upper, corner);
            }
        }
        known.push_back({.first_triangle = facet.triangles.front(),
                         .plane = facet.plane,
                         .deviation = facet.deviation,
                         .is_one_sided = !options.one_sided.empty() && options.one_sided[i] != 0,
                         .box = box});
    }
    return known;
}

// What is kept of a facet goes into wedges bit by bit, and 0 equals -0.
bool same_bits(double a, double b) noexcept {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same_bits(const Vec3& a, const Vec3& b) noexcept {
    return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

bool is_unchanged(const KnownPose& now, FacetId i, const KnownPose& before, FacetId k) {
    const KnownFacet& a = now.facets[i];
    const KnownFacet& b = before.facets[k];
    return a.first_triangle == b.first_triangle && a.is_one_sided == b.is_one_sided &&
           same_bits(a.plane.normal, b.plane.normal) && same_bits(a.plane.offset, b.plane.offset) &&
           same_bits(a.deviation, b.deviation) &&
           // Facets that transmit have no edges here.
           std::ranges::equal(now.segments.edges_of(i),
                              before.segments.edges_of(k),
                              [](const BorderEdge& e, const BorderEdge& f) {
                                  return same_bits(e.from, f.from) && same_bits(e.to, f.to);
                              });
}

/// Per facet the equal one before, or kNone. Both are in the order of their lowest triangles, so
/// facets that stay are in one order.
std::vector<FacetId> facets_before(const KnownPose& now, const KnownPose& before) {
    std::vector<FacetId> numbers(now.facets.size(), kNone);
    if (now.segments.tolerance != before.segments.tolerance) {
        return numbers;
    }
    for (FacetId i = 0; i < numbers.size(); ++i) {
        const TriangleId triangle = now.facets[i].first_triangle;
        if (triangle < before.of_triangle.size() &&
            is_unchanged(now, i, before, before.of_triangle[triangle])) {
            numbers[i] = before.of_triangle[triangle];
        }
    }
    return numbers;
}

/// Per number before the one now, or kNone.
std::vector<std::uint32_t> inverse_of(std::span<const std::uint32_t> before, std::size_t count) {
    std::vector<std::uint32_t> after(count, kNone);
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] != kNone) {
            after[before[i]] = static_cast<std::uint32_t>(i);
        }
    }
    return after;
}

std::vector<Box> boxes_of(std::span<const KnownFacet> facets) {
    std::vector<Box> boxes;
    boxes.reserve(facets.size());
    for (const KnownFacet& facet : facets) {
        boxes.push_back(facet.box);
    }
    return boxes;
}

/// Finds the lines of a pose, of which all but lines and groups is known, from those of another.
class LineUpdate {
public:
    LineUpdate(const Facets& facets, const WedgeOptions& options, KnownPose& now, KnownPose& before)
        : facets_(facets),
          options_(options),
          now_(now),
          before_(before),
          facet_before_(facets_before(now, before)),
          facet_after_(inverse_of(facet_before_, before.facets.size())),
          segment_after_(inverse_of(now.segments.before, before.segments.segments.size())),
          is_kept_(before.segments.segments.size(), 1) {}

    void run();

private:
    void find_groups();
    void drop_group_of(std::uint32_t segment_before) {
        if (segment_before != kNone) {
            is_kept_[before_.group_of_segment[segment_before]] = 0;
        }
    }
    void drop_changed_groups();
    void drop_groups_near_changed_facets();
    void keep_lines();
    void add_other_lines();

    const Facets& facets_;
    const WedgeOptions& options_;
    KnownPose& now_;
    KnownPose& before_;
    std::vector<FacetId> facet_before_, facet_after_;
    std::vector<std::uint32_t> segment_after_;
    std::vector<std::uint8_t> is_kept_;  // per group before, by its segment
};

void LineUpdate::run() {
    find_groups();
    drop_changed_groups();
    drop_groups_near_changed_facets();
    keep_lines();
    add_other_lines();
    std::sort(now_.lines.begin(), now_.lines.end(), [](const KnownLine& a, const KnownLine& b) {
        return a.first_facet != b.first_facet ? a.first_facet < b.first_facet
               : a.origin != b.origin         ? lexicographic_less(a.origin, b.origin)
                                              : lexicographic_less(a.direction, b.direction);
    });
}

void LineUpdate::find_groups() {
    DisjointSets sets(now_.segments.segments.size());
    for (const BorderSegments::Contact& contact : now_.segments.contacts) {
        sets.unite(contact[0], contact[1]);
    }
    now_.group_of_segment.resize(now_.segments.segments.size());
    for (std::uint32_t i = 0; i < now_.group_of_segment.size(); ++i) {
        now_.group_of_segment[i] = sets.find(i);
    }
}

// A group is the same if each of its segments is there as before with the same edges of the same
// facets, and no other has come to it.
void LineUpdate::drop_changed_groups() {
    for (std::uint32_t i = 0; i < segment_after_.size(); ++i) {
        if (segment_after_[i] == kNone) {
            drop_group_of(i);
        }
    }
    const std::span contacts(now_.segments.contacts);
    for (const auto& contact : contacts.subspan(now_.segments.known_contacts)) {
        drop_group_of(now_.segments.before[contact[0]]);
        drop_group_of(now_.segments.before[contact[1]]);
    }
    for (std::size_t i = 0; i < before_.segments.edges.size(); ++i) {
        if (facet_after_[before_.segments.edges[i].facet] == kNone) {
            drop_group_of(before_.segments.segment_of_edge[i]);
        }
    }
    for (std::size_t i = 0; i < now_.segments.edges.size(); ++i) {
        if (facet_before_[now_.segments.edges[i].facet] == kNone) {
            drop_group_of(now_.segments.before[now_.segments.segment_of_edge[i]]);
        }
    }
}

// A facet that a line passes through has no edge on it.
void LineUpdate::drop_groups_near_changed_facets() {
    std::vector<Box> changed;
    for (std::size_t i = 0; i < facet_before_.size(); ++i) {
        if (facet_before_[i] == kNone) {
            changed.push_back(now_.facets[i].box);
        }
    }
    for (std::size_t i = 0; i < facet_after_.size(); ++i) {
        if (facet_after_[i] == kNone) {
            changed.push_back(before_.facets[i].box);
        }
    }
    const BoxTree tree(changed);
    for (const KnownLine& line : before_.lines) {
        if (is_kept_[line.group] != 0 && tree.any_overlapping(line.box)) {
            is_kept_[line.group] = 0;
        }
    }
}

void LineUpdate::keep_lines() {
    for (KnownLine& line : before_.lines) {
        if (is_kept_[line.group] == 0) {
            continue;
        }
        line.group = now_.group_of_segment[segment_after_[line.group]];
        line.first_facet = facet_after_[line.first_facet];
        for (Wedge& wedge : line.wedges) {
            for (WedgeFace& face : wedge.faces) {
                face.facet = facet_after_[face.facet];
            }
        }
        now_.lines.push_back(std::move(line));
    }
    now_.kept_lines = now_.lines.size();
}

void LineUpdate::add_other_lines() {
    std::vector<std::vector<BorderEdge>> edges_of_group(now_.segments.segments.size());
    for (std::size_t i = 0; i < now_.segments.edges.size(); ++i) {
        const std::uint32_t segment = now_.segments.segment_of_edge[i];
        const std::uint32_t before = now_.segments.before[segment];
        if (before == kNone || is_kept_[before_.group_of_segment[before]] == 0) {
            edges_of_group[now_.group_of_segment[segment]].push_back(now_.segments.edges[i]);
        }
    }
    const double tolerance = now_.segments.tolerance;
    std::optional<BoxTree> boxes;
    std::vector<BorderLine> lines;
    for (std::uint32_t group = 0; group < edges_of_group.size(); ++group) {
        lines.clear();
        split_into_lines(std::move(edges_of_group[group]), tolerance, lines);
        if (!lines.empty() && !boxes) {
            boxes.emplace(boxes_of(now_.facets));
        }
        for (const BorderLine& line : lines) {
            KnownLine& known = now_.lines.emplace_back();
            known = {.first_facet = line.edges.front().facet,
                     .origin = line.origin,
                     .direction = line.direction,
                     .box = line.box(tolerance),
                     .group = group};
            find_line_wedges(
                facets_, options_, line, boxes->overlapping(known.box), tolerance, known.wedges);
        }
    }
}

}  // namespace

struct WedgeFinder::State {
    KnownPose pose;
    std::vector<Wedge> wedges;
};

WedgeFinder::WedgeFinder() : state_(std::make_unique<State>()) {}
WedgeFinder::WedgeFinder(WedgeFinder&&) noexcept = default;
WedgeFinder& WedgeFinder::operator=(WedgeFinder&&) noexcept = default;
WedgeFinder::~WedgeFinder() = default;

const std::vector<Wedge>& WedgeFinder::find(const Facets& facets, const WedgeOptions& options) {
    KnownPose before = std::exchange(state_->pose, {});
    KnownPose now{
        .facets = known_facets(facets, options),
        .of_triangle = facets.of_triangle,
        .segments = find_border_segments(
            facets, options.transmissive, kLineTolerances * facets.tolerance, before.segments)};
    LineUpdate(facets, options, now, before).run();
    state_->wedges.clear();
    for (const KnownLine& line : now.lines) {
        state_->wedges.insert(state_->wedges.end(), line.wedges.begin(), line.wedges.end());
    }
    state_->pose = std::move(now);
    return state_->wedges;
}

std::size_t WedgeFinder::lines() const noexcept {
    return state_->pose.lines.size();
}

std::size_t WedgeFinder::kept_lines() const noexcept {
    return state_->pose.kept_lines;
}

std::vector<Wedge> find_wedges(const Facets& facets, const WedgeOptions& options) {
    return WedgeFinder().find(facets, options);
}

}  // namespace earshot::geometry
