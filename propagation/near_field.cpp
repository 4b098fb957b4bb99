// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/near_field.h"

#include "earshot/propagation/internal/spiral.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace earshot::propagation {

using geometry::Hit;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Of the disc over which the irradiance about a point is averaged, metres.
constexpr double kDiscRadius = 1.0;
constexpr double kMaxCellEdge = 0.25;  // metres
/// Triangles whose planes differ by less than this belong to one plane: the cosine of the angle,
/// and metres. Both are far above rounding and far below what changes a sound field.
constexpr double kMinPlaneCosine = 1.0 - 1e-9;
constexpr double kMaxPlaneDistance = 1e-5;
constexpr std::uint32_t kMaxDivisions = 4096;

/// Planes that reflect, from the listener on.
using Reflections = std::vector<std::size_t>;

}  // namespace

Vec3 probe_direction(std::size_t i) noexcept {
    return spiral_direction(i, kProbeDirections);
}

std::optional<std::size_t> NearField::Patch::cell_at(double u, double v) const noexcept {
    const double n = divisions;
    const auto index = [n](double weight) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(weight * n), 0.0, n - 1.0));
    };
    const std::uint32_t row = index(v);
    // A weight may pass the edge opposite of its corner by a rounding.
    const std::uint32_t column = std::min(index(u), divisions - 1 - row);
    if (column < first_column || column - first_column >= columns || row < first_row ||
        row - first_row >= rows) {
        return std::nullopt;
    }
    // The upper half of a square lies beyond its diagonal; on the triangle's edge there is none.
    const bool is_upper = u * n - column + (v * n - row) > 1.0 && column + row + 1 < divisions;
    return 2 * (static_cast<std::size_t>(row - first_row) * columns + (column - first_column)) +
           (is_upper ? 1 : 0);
}

/// Builds the tables of one listener.
class NearField::Builder {
public:
    Builder(NearField& field,
            const bvh::MeshBvh& bvh,
            std::span<const std::uint32_t> material_of_triangle,
            std::span<const RaySurface> surfaces,
            const Vec3& listener,
            double offset)
        : field_(field),
          bvh_(bvh),
          material_of_triangle_(material_of_triangle),
          surfaces_(surfaces),
          listener_(listener),
          offset_(offset) {}

    void cut(const std::vector<TriangleId>& candidates);
    void join_surfaces();
    void look();
    void spread();

private:
    struct Cell {
        Vec3 centre{0.0};
        double area = 0.0;  // 0: no cell of its triangle
        std::vector<NearContribution> contributions;
    };
    /// Directions that see one cell through the same reflections.
    struct Seen {
        double count = 0.0;
        Vec3 points{0.0}, images{0.0};  // sums
        Vec3 side{0.0};
    };
    struct Probe {
        Ray ray;
        TriangleId left = 0;
        Vec3 direction{0.0};  // at the listener
        double travelled = 0.0;
        Reflections reflections{};
    };

    const Vec3& corner(TriangleId triangle, std::size_t i) const {
        return bvh_.mesh().positions[bvh_.mesh().triangles[triangle][i]];
    }
    const RaySurface& surface_of(TriangleId triangle, bool is_back = false) const {
        return surfaces_[2 * material_of_triangle_[triangle] + (is_back ? 1 : 0)];
    }
    const Patch* patch_of(TriangleId triangle) const;
    /// Notes what a probe sees, and reflects it. False: it ends.
    bool advance(Probe& probe, const Hit& hit);
    std::uint32_t factor_of(const Reflections& reflections);
    void spread(std::size_t seen_patch,
                std::size_t seen_cell,
                const Seen& seen,
                std::uint32_t factor);

    NearField& field_;
    const bvh::MeshBvh& bvh_;
    std::span<const std::uint32_t> material_of_triangle_;
    std::span<const RaySurface> surfaces_;
    Vec3 listener_;
    double offset_;
    std::vector<Cell> cells_;
    std::vector<Vec3> normals_;                // per patch
    std::vector<std::size_t> plane_of_patch_;  // patches of one plane and material
    std::vector<std::vector<std::size_t>> patches_of_plane_;
    // Ordered, so that sums have the same bits everywhere: reflections, patch, cell, front.
    std::map<std::tuple<Reflections, std::size_t, std::size_t, bool>, Seen> seen_;
    std::map<Reflections, std::uint32_t> factor_index_;
};

// Cuts the triangles near the listener into cells.
void NearField::Builder::cut(const std::vector<TriangleId>& candidates) {
    for (const TriangleId triangle : candidates) {
        const Vec3 a = corner(triangle, 0);
        const Vec3 ab = corner(triangle, 1) - a, ac = corner(triangle, 2) - a;
        const Vec3 across = glm::cross(ab, ac);
        const double twice_area = glm::length(across);
        if (!(twice_area > 0.0)) {
            continue;
        }
        const double longest = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
        Patch patch{.triangle = triangle};
        patch.divisions = static_cast<std::uint32_t>(
            std::clamp(std::ceil(longest / kMaxCellEdge), 1.0, double{kMaxDivisions}));
        const double n = patch.divisions;
        // The range of each weight within reach of the discs: its gradient has the length of the
        // opposite edge over twice the area.
        const double max_distance = kNearDistance + kDiscRadius;
        const Vec3 to_foot = listener_ - a;
        const auto range = [&](double weight, double gradient) {
            const double low =
                std::clamp(std::floor((weight - max_distance * gradient) * n), 0.0, n);
            const double high =
                std::clamp(std::ceil((weight + max_distance * gradient) * n), low, n);
            return std::pair(static_cast<std::uint32_t>(low),
                             static_cast<std::uint32_t>(high - low));
        };
        const double squared = twice_area * twice_area;
        const double u = glm::dot(glm::cross(to_foot, ac), across) / squared;
        const double v = glm::dot(glm::cross(ab, to_foot), across) / squared;
        std::tie(patch.first_column, patch.columns) = range(u, glm::length(ac) / twice_area);
        std::tie(patch.first_row, patch.rows) = range(v, glm::length(ab) / twice_area);
        patch.first_cell = cells_.size();
        for (std::uint32_t row = patch.first_row; row < patch.first_row + patch.rows; ++row) {
            for (std::uint32_t column = patch.first_column;
                 column < patch.first_column + patch.columns;
                 ++column) {
                for (const bool is_upper : {false, true}) {
                    Cell& cell = cells_.emplace_back();
                    if (column + row + (is_upper ? 1 : 0) < patch.divisions) {
                        const double third = is_upper ? 2.0 / 3.0 : 1.0 / 3.0;
                        cell.centre = a + (column + third) / n * ab + (row + third) / n * ac;
                        cell.area = 0.5 * twice_area / (n * n);
                    }
                }
            }
        }
        field_.patches_.push_back(patch);
        normals_.push_back(across / twice_area);
    }
}

// Joins triangles of one plane and material.
void NearField::Builder::join_surfaces() {
    for (std::size_t p = 0; p < field_.patches_.size(); ++p) {
        const TriangleId triangle = field_.patches_[p].triangle;
        const auto is_part_of = [&](std::size_t first) {
            const TriangleId other = field_.patches_[first].triangle;
            return material_of_triangle_[other] == material_of_triangle_[triangle] &&
                   std::abs(glm::dot(normals_[first], normals_[p])) >= kMinPlaneCosine &&
                   std::abs(glm::dot(normals_[first], corner(triangle, 0) - corner(other, 0))) <=
                       kMaxPlaneDistance;
        };
        const auto found = std::find_if(
            patches_of_plane_.begin(),
            patches_of_plane_.end(),
            [&](const std::vector<std::size_t>& patches) { return is_part_of(patches.front()); });
        plane_of_patch_.push_back(static_cast<std::size_t>(found - patches_of_plane_.begin()));
        if (found == patches_of_plane_.end()) {
            patches_of_plane_.push_back({p});
        } else {
            found->push_back(p);
        }
    }
}

const NearField::Patch* NearField::Builder::patch_of(TriangleId triangle) const {
    const auto found =
        std::lower_bound(field_.patches_.begin(),
                         field_.patches_.end(),
                         triangle,
                         [](const Patch& patch, TriangleId id) { return patch.triangle < id; });
    return found != field_.patches_.end() && found->triangle == triangle ? &*found : nullptr;
}

bool NearField::Builder::advance(Probe& probe, const Hit& hit) {
    const double distance = probe.travelled + hit.t;
    const Patch* patch = patch_of(hit.triangle);
    if (!(distance < kNearDistance) || patch == nullptr) {
        return false;
    }
    const auto index = static_cast<std::size_t>(patch - field_.patches_.data());
    const Vec3& normal = normals_[index];
    const double along = glm::dot(normal, probe.ray.direction);
    const RaySurface& surface = surface_of(hit.triangle, along > 0.0);
    const auto cell = patch->cell_at(hit.u, hit.v);
    if (!cell) {
        return false;
    }
    const Vec3 point = probe.ray.origin + hit.t * probe.ray.direction;
    Seen& seen = seen_[{probe.reflections, index, *cell, along < 0.0}];
    seen.count += 1.0;
    seen.points += point;
    seen.images += listener_ + distance * probe.direction;
    seen.side = along < 0.0 ? normal : -normal;
    // On to what the surface reflects.
    if (probe.reflections.size() == kMaxNearReflections ||
        *std::max_element(surface.specular.begin(), surface.specular.end()) == 0.0) {
        return false;
    }
    probe.reflections.push_back(plane_of_patch_[index]);
    probe.travelled = distance;
    probe.ray = {point + offset_ * seen.side,
                 glm::normalize(probe.ray.direction - 2.0 * along * normal)};
    probe.left = hit.triangle;
    return true;
}

// Finds what the listener sees near, directly and by reflections.
void NearField::Builder::look() {
    std::vector<Probe> probes;
    for (std::size_t i = 0; i < kProbeDirections; ++i) {
        const Vec3 direction = probe_direction(i);
        probes.push_back({.ray = {listener_, direction}, .direction = direction});
    }
    std::vector<Ray> rays;
    std::vector<TriangleId> left;
    std::vector<std::optional<Hit>> hits;
    while (!probes.empty()) {
        rays.clear();
        left.clear();
        for (const Probe& probe : probes) {
            rays.push_back(probe.ray);
            left.push_back(probe.left);
        }
        hits.resize(rays.size());
        if (probes.front().reflections.empty()) {
            bvh_.closest_hits(rays, hits);
        } else {
            bvh_.closest_hits(bvh::SecondaryRays{.rays = rays, .origin_triangles = left}, hits);
        }
        std::size_t kept = 0;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            if (hits[i] && advance(probes[i], *hits[i])) {
                if (kept != i) {
                    probes[kept] = std::move(probes[i]);
                }
                ++kept;
            }
        }
        probes.resize(kept);
    }
}

std::uint32_t NearField::Builder::factor_of(const Reflections& reflections) {
    const auto [found, is_new] =
        factor_index_.try_emplace(reflections, static_cast<std::uint32_t>(field_.factors_.size()));
    if (is_new) {
        audio::Spectrum factor;
        factor.fill(1.0);
        std::vector<std::uint32_t>& materials = field_.factor_materials_.emplace_back();
        for (const std::size_t plane : reflections) {
            const Patch& patch = field_.patches_[patches_of_plane_[plane].front()];
            materials.push_back(material_of_triangle_[patch.triangle]);
            const audio::Spectrum& specular = surface_of(patch.triangle).specular;
            for (std::size_t band = 0; band < factor.size(); ++band) {
                factor[band] *= specular[band];
            }
        }
        field_.factors_.push_back(factor);
    }
    return found->second;
}

// A direction sees scattered energy per area over pi, and stands for a solid angle of 4 pi / M.
void NearField::Builder::spread(std::size_t seen_patch,
                                std::size_t seen_cell,
                                const Seen& seen,
                                std::uint32_t factor) {
    const Vec3 point = seen.points / seen.count;
    const Vec3 image = seen.images / seen.count;
    std::vector<std::size_t> disc;
    double area = 0.0;
    for (const std::size_t other : patches_of_plane_[plane_of_patch_[seen_patch]]) {
        const Patch& patch = field_.patches_[other];
        for (std::size_t cell = patch.first_cell; cell < patch.end_cell(); ++cell) {
            const Vec3 apart = cells_[cell].centre - point;
            if (cells_[cell].area > 0.0 &&
                (glm::dot(apart, apart) < kDiscRadius * kDiscRadius ||
                 cell == field_.patches_[seen_patch].first_cell + seen_cell)) {
                disc.push_back(cell);
                area += cells_[cell].area;
            }
        }
    }
    if (!(area > 0.0)) {
        return;
    }
    const double solid_angle = seen.count * (4.0 / kProbeDirections);
    const double weight = solid_angle / area;
    for (const std::size_t cell : disc) {
        std::vector<NearContribution>& contributions = cells_[cell].contributions;
        auto found =
            std::find_if(contributions.begin(), contributions.end(), [&](const auto& other) {
                return other.reflections == factor && glm::dot(other.side, seen.side) > 0.0;
            });
        if (found == contributions.end()) {
            found = contributions.insert(found, {.side = seen.side, .reflections = factor});
        }
        found->weight += weight;
        found->point += weight * point;
        found->image += weight * image;
    }
}

void NearField::Builder::spread() {
    for (const auto& [key, seen] : seen_) {
        const auto& [reflections, patch, cell, is_front] = key;
        spread(patch, cell, seen, factor_of(reflections));
    }
    for (Cell& cell : cells_) {
        field_.first_of_cell_.push_back(static_cast<std::uint32_t>(field_.contributions_.size()));
        for (NearContribution& contribution : cell.contributions) {
            contribution.point /= contribution.weight;
            contribution.image /= contribution.weight;
            field_.contributions_.push_back(contribution);
        }
    }
    field_.first_of_cell_.push_back(static_cast<std::uint32_t>(field_.contributions_.size()));
}

NearField::NearField(const bvh::MeshBvh& bvh,
                     std::span<const std::uint32_t> material_of_triangle,
                     std::span<const RaySurface> surfaces,
                     const Vec3& listener,
                     double offset) {
    const geometry::SphereRegion sphere(listener, kNearDistance + kDiscRadius);
    Builder builder(*this, bvh, material_of_triangle, surfaces, listener, offset);
    builder.cut(bvh.overlapping(sphere));
    builder.join_surfaces();
    builder.look();
    builder.spread();
}

std::span<const NearContribution> NearField::contributions(const Hit& hit) const noexcept {
    const auto patch = std::lower_bound(
        patches_.begin(), patches_.end(), hit.triangle, [](const Patch& other, TriangleId id) {
            return other.triangle < id;
        });
    if (patch == patches_.end() || patch->triangle != hit.triangle) {
        return {};
    }
    const auto cell = patch->cell_at(hit.u, hit.v);
    if (!cell) {
        return {};
    }
    const std::uint32_t begin = first_of_cell_[patch->first_cell + *cell];
    const std::uint32_t end = first_of_cell_[patch->first_cell + *cell + 1];
    return std::span(contributions_).subspan(begin, end - begin);
}

}  // namespace earshot::propagation
