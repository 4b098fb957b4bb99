// SPDX-License-Identifier: MIT
#include "earshot/visibility/cell_shape.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace earshot::visibility {

using geometry::Vec3;

namespace {

// Of the region's diagonal and of its largest coordinate: see plane_slack().
constexpr double kPlaneSlack = 1e-9;
constexpr double kRounding = 1e-14;

using Ring = std::vector<std::uint32_t>;

/// Twice the area of a polygon, along its normal.
Vec3 twice_area(std::span<const Vec3> corners, std::span<const std::uint32_t> ring) {
    Vec3 sum(0.0);
    for (std::size_t i = 2; i < ring.size(); ++i) {
        sum += glm::cross(corners[ring[i - 1]] - corners[ring[0]],
                          corners[ring[i]] - corners[ring[0]]);
    }
    return sum;
}

/// The corners of a shape and where its edges cross a plane, each of them once.
class Cut {
public:
    Cut(std::span<const Vec3> corners, const CellNode& plane, double slack)
        : corners_(corners.begin(), corners.end()), heights_(corners.size()) {
        sides_.resize(corners.size());
        for (std::size_t i = 0; i < corners.size(); ++i) {
            heights_[i] = glm::dot(plane.normal, corners[i]) - plane.offset;
            sides_[i] = heights_[i] < -slack ? -1 : heights_[i] > slack ? 1 : 0;
        }
    }

    bool has_side(int side) const {
        return std::find(sides_.begin(), sides_.end(), side) != sides_.end();
    }

    /// The part of a face on one side; empty if it is no more than an edge.
    Ring part(const Ring& ring, int side) {
        Ring part;
        bool has_corner_beside = false;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const std::uint32_t corner = ring[i];
            const std::uint32_t next = ring[(i + 1) % ring.size()];
            if (sides_[corner] != -side) {
                part.push_back(corner);
                has_corner_beside = has_corner_beside || sides_[corner] == side;
            }
            if (sides_[corner] * sides_[next] < 0) {
                part.push_back(crossing(std::min(corner, next), std::max(corner, next)));
            }
        }
        if (!has_corner_beside || part.size() < 3) {
            part.clear();
        }
        return part;
    }

    bool is_on_plane(std::uint32_t corner) const { return sides_[corner] == 0; }
    const std::vector<Vec3>& corners() const { return corners_; }

private:
    std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
        const auto next = static_cast<std::uint32_t>(corners_.size());
        const auto [place, is_new] = crossings_.try_emplace(std::pair(a, b), next);
        if (is_new) {
            const double t = heights_[a] / (heights_[a] - heights_[b]);
            corners_.push_back(corners_[a] + t * (corners_[b] - corners_[a]));
            sides_.push_back(0);
        }
        return place->second;
    }

    std::vector<Vec3> corners_;
    std::vector<double> heights_;
    std::vector<int> sides_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
};

/// The face that closes what a plane has opened: along the edges on the plane, each in the other
/// direction than in the face it belongs to. Empty if they are not one ring.
Ring closing_face(const std::vector<CellFace>& faces, const Cut& cut) {
    std::map<std::uint32_t, std::uint32_t> next;
    for (const CellFace& face : faces) {
        for (std::size_t i = 0; i < face.corners.size(); ++i) {
            const std::uint32_t from = face.corners[i];
            const std::uint32_t to = face.corners[(i + 1) % face.corners.size()];
            if (cut.is_on_plane(from) && cut.is_on_plane(to) && !next.emplace(to, from).second) {
                return {};
            }
        }
    }
    Ring ring;
    if (next.size() < 3) {
        return ring;
    }
    std::uint32_t corner = next.begin()->first;
    do {
        ring.push_back(corner);
        const auto place = next.find(corner);
        if (place == next.end()) {
            return {};
        }
        corner = place->second;
    } while (corner != ring.front() && ring.size() <= next.size());
    if (ring.size() != next.size()) {
        ring.clear();
    }
    return ring;
}

/// Leaves out the corners that no face has.
void compact(std::vector<Vec3>& corners, std::vector<CellFace>& faces) {
    constexpr std::uint32_t kUnused = 0xffffffffU;
    std::vector<std::uint32_t> place(corners.size(), kUnused);
    std::vector<Vec3> used;
    for (CellFace& face : faces) {
        for (std::uint32_t& corner : face.corners) {
            if (place[corner] == kUnused) {
                place[corner] = static_cast<std::uint32_t>(used.size());
                used.push_back(corners[corner]);
            }
            corner = place[corner];
        }
    }
    corners = std::move(used);
}

}  // namespace

CellShape::CellShape(const ViewRegion& region) {
    // Bit 0, 1, 2 of a corner's number chooses the upper end along x, y, z.
    for (unsigned i = 0; i < 8; ++i) {
        corners_.emplace_back((i & 1U) != 0 ? region.upper.x : region.lower.x,
                              (i & 2U) != 0 ? region.upper.y : region.lower.y,
                              (i & 4U) != 0 ? region.upper.z : region.lower.z);
    }
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kRings = {
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& ring : kRings) {
        faces_.push_back({{ring.begin(), ring.end()}, kBorder});
    }
}

double CellShape::volume() const noexcept {
    const Vec3 inside = vertex_mean();
    double sum = 0.0;
    for (const CellFace& face : faces_) {
        const Vec3 first = corners_[face.corners[0]] - inside;
        for (std::size_t i = 2; i < face.corners.size(); ++i) {
            sum += glm::dot(first,
                            glm::cross(corners_[face.corners[i - 1]] - inside,
                                       corners_[face.corners[i]] - inside));
        }
    }
    return sum / 6.0;
}

Vec3 CellShape::vertex_mean() const noexcept {
    Vec3 sum(0.0);
    for (const Vec3& corner : corners_) {
        sum += corner;
    }
    return corners_.empty() ? sum : sum / static_cast<double>(corners_.size());
}

ViewRegion CellShape::box() const noexcept {
    ViewRegion box;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        box.lower = i == 0 ? corners_[i] : glm::min(box.lower, corners_[i]);
        box.upper = i == 0 ? corners_[i] : glm::max(box.upper, corners_[i]);
    }
    return box;
}

bool CellShape::contains(const Vec3& point, double slack) const noexcept {
    return !faces_.empty() && std::all_of(faces_.begin(), faces_.end(), [&](const CellFace& face) {
        const Vec3 outward = twice_area(corners_, face.corners);
        return glm::dot(outward, point - corners_[face.corners[0]]) <= slack * glm::length(outward);
    });
}

std::optional<CellShape::Halves> CellShape::split(const CellNode& plane,
                                                  std::uint32_t node,
                                                  double slack) const {
    Cut cut(corners_, plane, slack);
    if (!cut.has_side(-1) || !cut.has_side(1)) {
        return std::nullopt;
    }
    Halves halves{CellShape(), CellShape()};
    for (const int side : {-1, 1}) {
        CellShape& half = side < 0 ? halves.back : halves.front;
        for (const CellFace& face : faces_) {
            if (Ring part = cut.part(face.corners, side); !part.empty()) {
                half.faces_.push_back({std::move(part), face.node});
            }
        }
        Ring ring = closing_face(half.faces_, cut);
        if (ring.empty()) {
            return std::nullopt;
        }
        half.faces_.push_back({std::move(ring), node});
        half.corners_ = cut.corners();
        compact(half.corners_, half.faces_);
    }
    return halves;
}

double plane_slack(const ViewRegion& region) noexcept {
    const Vec3 far = glm::max(glm::abs(region.lower), glm::abs(region.upper));
    return std::max(kPlaneSlack * glm::length(region.size()),
                    kRounding * std::max({far.x, far.y, far.z}));
}

std::vector<CellShape> leaf_shapes(const ViewCells& cells) {
    const double slack = plane_slack(cells.region());
    std::vector<CellShape> shapes(cells.leaves(), CellShape::empty());
    struct Part {
        std::uint32_t child;
        CellShape shape;
    };
    std::vector<Part> stack;
    stack.push_back({cells.nodes().empty() ? kCellLeaf : 0, CellShape(cells.region())});
    while (!stack.empty()) {
        Part part = std::move(stack.back());
        stack.pop_back();
        if ((part.child & kCellLeaf) != 0) {
            shapes[part.child & ~kCellLeaf] = std::move(part.shape);
            continue;
        }
        CellNode plane = cells.nodes()[part.child];
        const double length = glm::length(plane.normal);
        plane.normal /= length;
        plane.offset /= length;
        if (auto halves = part.shape.split(plane, part.child, slack)) {
            stack.push_back({plane.front, std::move(halves->front)});
            stack.push_back({plane.back, std::move(halves->back)});
        } else {
            // All of it is on one side.
            const bool is_back = glm::dot(plane.normal, part.shape.vertex_mean()) < plane.offset;
            stack.push_back({is_back ? plane.back : plane.front, std::move(part.shape)});
        }
    }
    return shapes;
}

}  // namespace earshot::visibility
