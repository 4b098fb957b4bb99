// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_mending.h"

#include "earshot/geometry/triangulate.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <iterator>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::VertexId;

/// One copy being made.
class Mending {
public:
    Mending(const Scene& scene, const ModelReport& report, double time)
        : scene_(scene),
          report_(report),
          time_(time),
          positions_(scene.mesh.positions_at(time)),
          is_removed_(scene.mesh.triangles().size(), false) {}

    MendedModel run(const MendingOptions& options) {
        choose_removals();
        copy_triangles();
        fill_holes(options.max_hole_area);
        return finish();
    }

private:
    void choose_removals() {
        std::vector<bool> is_kept(is_removed_.size(), false);
        for (const TriangleId id : report_.topology.clean.kept) {
            is_kept[id] = true;
        }
        for (const geometry::DoubledFace& pair : report_.topology.doubled) {
            done_.doubled.push_back(pair.repeated);
            is_removed_[pair.repeated] = true;
        }
        for (TriangleId id = 0; id < is_kept.size(); ++id) {
            if (!is_kept[id] && !is_removed_[id]) {
                done_.degenerate.push_back(id);
                is_removed_[id] = true;
            }
        }
        for (const TriangleId id : report_.proven_unreached) {
            done_.unreached.push_back(id);
            is_removed_[id] = true;
        }
        std::copy_if(report_.unreached.begin(),
                     report_.unreached.end(),
                     std::back_inserter(done_.doubtful),
                     [this](TriangleId id) { return !is_removed_[id]; });
    }

    void copy_triangles() {
        const std::vector<VertexId>& weld = report_.topology.clean.weld;
        for (TriangleId id = 0; id < is_removed_.size(); ++id) {
            if (is_removed_[id]) {
                continue;
            }
            const auto& [a, b, c] = scene_.mesh.triangles()[id];
            Triangle triangle{weld[a], weld[b], weld[c]};
            if (std::binary_search(
                    report_.reversed_triangles.begin(), report_.reversed_triangles.end(), id)) {
                std::swap(triangle[1], triangle[2]);
                done_.turned.push_back(id);
            }
            triangles_.push_back(triangle);
            materials_.push_back(scene_.material_of_triangle[id]);
        }
    }

    /// An edge of a triangle, from its lower to its higher vertex.
    struct Edge {
        VertexId lower = 0, upper = 0;
        std::size_t triangle = 0;
        bool is_descending = false;  ///< the triangle runs from the higher to the lower vertex

        auto operator<=>(const Edge&) const = default;
    };

    std::vector<Edge> sorted_edges() const {
        std::vector<Edge> edges;
        edges.reserve(3 * triangles_.size());
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const VertexId a = triangles_[t][k];
                const VertexId b = triangles_[t][(k + 1) % 3];
                edges.push_back({std::min(a, b), std::max(a, b), t, b < a});
            }
        }
        std::sort(edges.begin(), edges.end());
        return edges;
    }

    void fill_holes(double max_area) {
        const std::vector<Edge> edges = sorted_edges();
        for (std::size_t i = 0; i < report_.topology.holes.size(); ++i) {
            const geometry::HoleLoop& hole = report_.topology.holes[i];
            if (hole.is_outline || hole.area > max_area || hole.rim.size() < 3) {
                continue;
            }
            const auto [lower, upper] = std::minmax(hole.rim[0], hole.rim[1]);
            const auto beside =
                std::lower_bound(edges.begin(), edges.end(), Edge{.lower = lower, .upper = upper});
            if (beside == edges.end() || beside->lower != lower || beside->upper != upper) {
                continue;  // its surface is gone
            }
            const bool same_direction = beside->is_descending == (hole.rim[1] < hole.rim[0]);
            const std::uint32_t material = materials_[beside->triangle];
            std::size_t added = 0;
            for (Triangle cap : geometry::triangulate(positions_, hole.rim)) {
                // Neighbours of one front run along their edge in opposite directions.
                if (same_direction) {
                    std::swap(cap[1], cap[2]);
                }
                triangles_.push_back(cap);
                materials_.push_back(material);
                ++added;
            }
            done_.filled.push_back({i, added});
        }
    }

    MendedModel finish() {
        // Vertices in the order of their first use.
        std::vector<VertexId> number(positions_.size(), kUnused);
        std::vector<bool> was_used(positions_.size(), false);
        for (const Triangle& triangle : scene_.mesh.triangles()) {
            for (const VertexId vertex : triangle) {
                was_used[vertex] = true;
            }
        }
        geometry::Mesh mesh;
        for (Triangle triangle : triangles_) {
            for (VertexId& vertex : triangle) {
                if (number[vertex] == kUnused) {
                    number[vertex] = static_cast<VertexId>(mesh.positions.size());
                    mesh.positions.push_back(positions_[vertex]);
                }
                vertex = number[vertex];
            }
            mesh.triangles.push_back(triangle);
        }
        for (VertexId v = 0; v < positions_.size(); ++v) {
            done_.welded_vertices += was_used[v] && report_.topology.clean.weld[v] != v ? 1 : 0;
        }
        for (const Vec3& position : mesh.positions) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto kept = static_cast<double>(static_cast<float>(position[axis]));
                done_.max_rounding = std::max(done_.max_rounding, std::abs(kept - position[axis]));
            }
        }
        MendedModel mended;
        mended.scene.name = scene_.name;
        mended.scene.materials = scene_.materials;
        mended.scene.material_of_triangle = std::move(materials_);
        for (const Emitter& source : scene_.sources) {
            mended.scene.sources.push_back(at_rest(source));
        }
        for (const Emitter& listener : scene_.listeners) {
            mended.scene.listeners.push_back(at_rest(listener));
        }
        mended.scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
        mended.report = std::move(done_);
        return mended;
    }

    /// The emitter without the node that it rides on.
    Emitter at_rest(const Emitter& emitter) const {
        const Pose pose = scene_.pose_at(emitter, time_);
        return {.name = emitter.name,
                .position = pose.position,
                .directivity = emitter.directivity,
                .looks_at = pose.position + pose.front};
    }

    static constexpr VertexId kUnused = 0xffffffffU;

    const Scene& scene_;
    const ModelReport& report_;
    double time_;
    std::vector<Vec3> positions_;
    std::vector<bool> is_removed_;
    std::vector<Triangle> triangles_;  // by welded vertices
    std::vector<std::uint32_t> materials_;
    MendingReport done_;
};

}  // namespace

void require_still(const Scene& scene) {
    if (scene.mesh.duration() > 0.0) {
        throw Error(scene.name,
                    "moves, and what is out of reach now may be needed at another instant",
                    "mend it as it is at one instant (--time), or a scene without animation");
    }
}

MendedModel mend_model(const Scene& scene,
                       const ModelReport& report,
                       const MendingOptions& options) {
    if (!options.freeze) {
        require_still(scene);
    }
    return Mending(scene, report, options.time).run(options);
}

}  // namespace earshot::propagation
