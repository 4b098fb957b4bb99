// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/line_wedges.h"

#include "earshot/base/math.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace earshot::geometry {
namespace {

/// Radians. Half-planes closer than this are layers of one surface; they bound no air of their own.
constexpr double kLayerAngle = 1e-3;

/// A facet beside a line, as it looks along the line.
struct HalfPlane {
    FacetId facet = 0;
    Vec3 inward{0.0};    // unit vector, perpendicular to the line
    double angle = 0.0;  // about the line, from any zero
};

/// Layers of one surface, ascending by facet.
using Layers = std::vector<HalfPlane>;

class LineWedges {
public:
    LineWedges(const Facets& facets,
               const WedgeOptions& options,
               const BorderLine& line,
               double tolerance)
        : facets_(facets), options_(options), line_(line), tolerance_(tolerance) {
        for (const BorderEdge& edge : line.edges) {
            for (const Vec3& end : {edge.from, edge.to}) {
                add_break(end);
            }
        }
    }

    void add_facet_nearby(FacetId facet);
    void find(std::vector<Wedge>& wedges);

private:
    struct Break {
        double z = 0.0;
        Vec3 point{0.0};
    };

    void add_break(const Vec3& point) {
        const double z = z_of(point);
        breaks_.push_back({z, point});
        low_ = std::min(low_, z);
        high_ = std::max(high_, z);
    }
    double z_of(const Vec3& point) const noexcept { return line_.z_of(point); }
    Vec3 point_at(double z) const noexcept { return line_.point_at(z); }
    void sort_breaks();
    HalfPlane half_plane(FacetId facet, const Vec3& inward) const;
    std::vector<HalfPlane> half_planes_at(double z) const;
    bool contains(FacetId facet, const Vec3& point) const;
    std::vector<Layers> layers_at(double z) const;
    std::optional<std::pair<HalfPlane, WedgeFace>> face_of(const Layers& layers,
                                                           const Vec3& into_air) const;
    std::optional<Wedge> sector(const Layers& first, const Layers& second) const;
    void finish(std::vector<Wedge>& wedges, std::size_t first) const;

    const Facets& facets_;
    const WedgeOptions& options_;
    const BorderLine& line_;
    double tolerance_;
    double low_ = std::numeric_limits<double>::infinity();
    double high_ = -std::numeric_limits<double>::infinity();
    std::vector<Break> breaks_;
    std::vector<FacetId> through_;  // facets in whose plane the line lies
};

// A facet that the line passes through has air on neither side of the line in its own plane. Where
// the line enters and leaves it, what bounds the air changes.
void LineWedges::add_facet_nearby(FacetId facet) {
    const Facet& surface = facets_.facets[facet];
    const double flatness = tolerance_ + surface.deviation;
    if ((!options_.transmissive.empty() && options_.transmissive[facet] != 0) ||
        std::abs(surface.plane.distance(point_at(low_))) > flatness ||
        std::abs(surface.plane.distance(point_at(high_))) > flatness) {
        return;
    }
    through_.push_back(facet);
    const double low = low_;
    const double high = high_;
    const Vec3 across = glm::cross(surface.plane.normal, line_.direction);
    for (const Loop& loop : surface.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vec3& a = loop[i];
            const Vec3& b = loop[(i + 1) % loop.size()];
            const double before = glm::dot(a - line_.origin, across);
            const double after = glm::dot(b - line_.origin, across);
            if ((before < -tolerance_ && after > tolerance_) ||
                (before > tolerance_ && after < -tolerance_)) {
                const double z = z_of(a + before / (before - after) * (b - a));
                if (z > low && z < high) {
                    add_break(point_at(z));
                }
            } else if (std::abs(before) <= tolerance_ && z_of(a) > low && z_of(a) < high) {
                add_break(a);
            }
        }
    }
}

void LineWedges::sort_breaks() {
    std::sort(breaks_.begin(), breaks_.end(), [](const Break& a, const Break& b) {
        return a.z != b.z ? a.z < b.z : lexicographic_less(a.point, b.point);
    });
    const auto is_same = [&](const Break& a, const Break& b) { return b.z - a.z <= tolerance_; };
    breaks_.erase(std::unique(breaks_.begin(), breaks_.end(), is_same), breaks_.end());
}

HalfPlane LineWedges::half_plane(FacetId facet, const Vec3& inward) const {
    // Any frame will do, as long as one line has one.
    const Vec3& t = line_.direction;
    const Vec3 size = glm::abs(t);
    const Vec3 axis = size.x <= size.y && size.x <= size.z ? Vec3(1.0, 0.0, 0.0)
                      : size.y <= size.z                   ? Vec3(0.0, 1.0, 0.0)
                                                           : Vec3(0.0, 0.0, 1.0);
    const Vec3 e1 = normalized(axis - glm::dot(axis, t) * t);
    const Vec3 e2 = glm::cross(t, e1);
    const Vec3 unit = normalized(inward - glm::dot(inward, t) * t);
    return {facet, unit, math::atan2(glm::dot(unit, e2), glm::dot(unit, e1))};
}

// By the winding of the outline's projection, as facets may overlap themselves.
bool LineWedges::contains(FacetId facet, const Vec3& point) const {
    const Facet& surface = facets_.facets[facet];
    const Vec3 u = glm::cross(surface.plane.normal, line_.direction);
    int winding = 0;
    for (const Loop& loop : surface.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vec3 a = loop[i] - point;
            const Vec3 b = loop[(i + 1) % loop.size()] - point;
            const double before = glm::dot(a, u);
            const double after = glm::dot(b, u);
            if ((before >= 0.0) == (after >= 0.0)) {
                continue;
            }
            const Vec3 crossing = a + before / (before - after) * (b - a);
            if (glm::dot(crossing, line_.direction) > 0.0) {
                winding += before < after ? 1 : -1;
            }
        }
    }
    return winding != 0;
}

std::vector<HalfPlane> LineWedges::half_planes_at(double z) const {
    std::vector<HalfPlane> found;
    for (const BorderEdge& edge : line_.edges) {
        const double from = z_of(edge.from);
        const double to = z_of(edge.to);
        if (std::min(from, to) < z && z < std::max(from, to)) {
            // The facet lies to the left of its outline.
            const Vec3 inward = glm::cross(facets_.facets[edge.facet].plane.normal,
                                           from < to ? line_.direction : -line_.direction);
            found.push_back(half_plane(edge.facet, inward));
        }
    }
    const std::size_t borders = found.size();
    for (const FacetId facet : through_) {
        const bool has_border =
            std::any_of(found.begin(),
                        found.begin() + static_cast<std::ptrdiff_t>(borders),
                        [&](const HalfPlane& border) { return border.facet == facet; });
        if (!has_border && contains(facet, point_at(z))) {
            const Vec3 inward = glm::cross(facets_.facets[facet].plane.normal, line_.direction);
            found.push_back(half_plane(facet, inward));
            found.push_back(half_plane(facet, -inward));
        }
    }
    return found;
}

std::vector<Layers> LineWedges::layers_at(double z) const {
    std::vector<HalfPlane> half_planes = half_planes_at(z);
    std::sort(half_planes.begin(), half_planes.end(), [](const HalfPlane& a, const HalfPlane& b) {
        return a.angle != b.angle ? a.angle < b.angle : a.facet < b.facet;
    });
    std::vector<Layers> layers;
    for (const HalfPlane& half : half_planes) {
        if (layers.empty() || half.angle - layers.back().front().angle > kLayerAngle) {
            layers.emplace_back();
        }
        layers.back().push_back(half);
    }
    // The last may continue at the first, a whole turn on.
    if (layers.size() > 1 &&
        layers.front().front().angle + 2.0 * math::kPi - layers.back().front().angle <=
            kLayerAngle) {
        layers.front().insert(layers.front().end(), layers.back().begin(), layers.back().end());
        layers.pop_back();
    }
    for (Layers& surface : layers) {
        std::sort(surface.begin(), surface.end(), [](const HalfPlane& a, const HalfPlane& b) {
            return a.facet < b.facet;
        });
    }
    return layers;
}

// The lowest of the layers that sound sees from the air.
std::optional<std::pair<HalfPlane, WedgeFace>> LineWedges::face_of(const Layers& layers,
                                                                   const Vec3& into_air) const {
    for (const HalfPlane& half : layers) {
        const Vec3& normal = facets_.facets[half.facet].plane.normal;
        const bool is_front = glm::dot(normal, into_air) > 0.0;
        if (is_front || options_.one_sided.empty() || options_.one_sided[half.facet] == 0) {
            return std::pair(half, WedgeFace{half.facet, is_front});
        }
    }
    return std::nullopt;
}

// The air between two surfaces, counter-clockwise about the line from the first to the second.
std::optional<Wedge> LineWedges::sector(const Layers& first, const Layers& second) const {
    const Vec3& t = line_.direction;
    const auto from = face_of(first, glm::cross(t, first.front().inward));
    const auto to = face_of(second, -glm::cross(t, second.front().inward));
    if (!from || !to) {
        return std::nullopt;
    }
    Wedge wedge;
    wedge.faces = {from->second, to->second};
    wedge.tangent = from->first.inward;
    if (&first == &second) {
        wedge.open_angle = 2.0 * math::kPi;
        return wedge;
    }
    const Vec3& u = from->first.inward;
    const Vec3& v = to->first.inward;
    const double angle = math::atan2(glm::dot(glm::cross(u, v), t), glm::dot(u, v));
    wedge.open_angle = angle > 0.0 ? angle : angle + 2.0 * math::kPi;
    if (std::abs(math::sin(math::kPi * math::kPi / wedge.open_angle)) <= kMinWedgeSine) {
        return std::nullopt;
    }
    return wedge;
}

void LineWedges::find(std::vector<Wedge>& wedges) {
    sort_breaks();
    const std::size_t first = wedges.size();
    std::vector<std::size_t> previous;  // the wedges that end where the interval begins
    for (std::size_t i = 0; i + 1 < breaks_.size(); ++i) {
        const std::vector<Layers> layers = layers_at(0.5 * (breaks_[i].z + breaks_[i + 1].z));
        std::vector<std::size_t> current;
        for (std::size_t k = 0; k < layers.size(); ++k) {
            auto wedge = sector(layers[k], layers[(k + 1) % layers.size()]);
            if (!wedge) {
                continue;
            }
            const auto same = std::find_if(previous.begin(), previous.end(), [&](std::size_t p) {
                return wedges[p].faces == wedge->faces &&
                       std::abs(wedges[p].open_angle - wedge->open_angle) <= kLayerAngle;
            });
            if (same != previous.end()) {
                wedges[*same].end = breaks_[i + 1].point;
                current.push_back(*same);
                continue;
            }
            wedge->begin = breaks_[i].point;
            wedge->end = breaks_[i + 1].point;
            current.push_back(wedges.size());
            wedges.push_back(*wedge);
        }
        previous = std::move(current);
    }
    finish(wedges, first);
}

void LineWedges::finish(std::vector<Wedge>& wedges, std::size_t first) const {
    for (std::size_t i = first; i < wedges.size(); ++i) {
        Wedge& wedge = wedges[i];
        wedge.direction = normalized(wedge.end - wedge.begin);
        wedge.tangent =
            normalized(wedge.tangent - glm::dot(wedge.tangent, wedge.direction) * wedge.direction);
        wedge.normal = glm::cross(wedge.direction, wedge.tangent);
    }
}

}  // namespace

void find_line_wedges(const Facets& facets,
                      const WedgeOptions& options,
                      const BorderLine& line,
                      std::span<const FacetId> nearby,
                      double tolerance,
                      std::vector<Wedge>& wedges) {
    LineWedges of_line(facets, options, line, tolerance);
    for (const FacetId facet : nearby) {
        of_line.add_facet_nearby(facet);
    }
    of_line.find(wedges);
}

}  // namespace earshot::geometry
