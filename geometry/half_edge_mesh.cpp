// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/half_edge_mesh.h"

#include "earshot/base/error.h"
#include "earshot/geometry/internal/surface_curves.h"
#include "earshot/geometry/internal/surface_samples.h"
#include "earshot/geometry/mesh_topology.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/BaseDecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalDeviationT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include <algorithm>
#include <queue>
#include <tuple>

namespace earshot::geometry {
namespace {

/// Connectivity alone: positions stay in the caller's arrays, in double precision.
using Connectivity = OpenMesh::TriMesh_ArrayKernelT<>;

/// Positions and normals in double precision, marks of what is deleted.
struct SurfaceTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
};
using Surface = OpenMesh::TriMesh_ArrayKernelT<SurfaceTraits>;

OpenMesh::VertexHandle handle_of(VertexId vertex) {
    return OpenMesh::VertexHandle(static_cast<int>(vertex));
}

VertexId id_of(OpenMesh::VertexHandle vertex) {
    return static_cast<VertexId>(vertex.idx());
}

/// Adds the faces to a mesh that has the vertices.
template <typename HalfEdgeMesh>
void add_faces(std::span<const Triangle> triangles, HalfEdgeMesh& mesh) {
    // OpenMesh writes what it refuses to standard error, where the library is silent.
    [[maybe_unused]] static const bool is_silent = [] {
        omerr().disable();
        return true;
    }();
    for (const auto& [a, b, c] : triangles) {
        if (!mesh.add_face(handle_of(a), handle_of(b), handle_of(c)).is_valid()) {
            throw Error("mesh", "its triangles are not an oriented manifold");
        }
    }
}

Connectivity connectivity_of(std::span<const Triangle> triangles, std::size_t vertex_count) {
    Connectivity mesh;
    mesh.reserve(vertex_count, 3 * triangles.size(), triangles.size());
    for (std::size_t v = 0; v < vertex_count; ++v) {
        mesh.add_vertex({0.0F, 0.0F, 0.0F});
    }
    add_faces(triangles, mesh);
    return mesh;
}

Surface surface_of(const MeshView& input) {
    Surface mesh;
    mesh.reserve(input.positions.size(), 3 * input.triangles.size(), input.triangles.size());
    for (const Vec3& p : input.positions) {
        mesh.add_vertex({p.x, p.y, p.z});
    }
    add_faces(input.triangles, mesh);
    mesh.update_face_normals();
    return mesh;
}

/// The half-edge of the triangle on the other side of a border half-edge.
HalfEdgeId inner_half_edge(const Connectivity& mesh,
                           std::span<const Triangle> triangles,
                           OpenMesh::HalfedgeHandle border) {
    const OpenMesh::HalfedgeHandle inner = mesh.opposite_halfedge_handle(border);
    const auto triangle = static_cast<TriangleId>(mesh.face_handle(inner).idx());
    const auto start = static_cast<VertexId>(mesh.from_vertex_handle(inner).idx());
    HalfEdgeId h = 3 * triangle;
    while (start_of(triangles, h) != start) {
        ++h;
    }
    return h;
}

namespace decimater = OpenMesh::Decimater;

/// No collapse turns a triangle by more: just more than a chamfer, half of a right angle, which
/// vanishes so. More leaves folds in which later collapses are stuck.
constexpr float kMaxTurnDegrees = 45.5F;

/// Collapses half-edges in the order of their quadric errors. OpenMesh's own loop asks all modules
/// about every half-edge around a change; here the costly questions are asked only about the
/// cheapest collapse of all.
class BoundedDecimater : private decimater::BaseDecimaterT<Surface> {
public:
    BoundedDecimater(Surface& surface, const DecimationInput& input, const DecimationLimits& limits)
        : BaseDecimaterT(surface),
          input_(input),
          limits_(limits),
          samples_({input.labels.begin(), input.labels.end()}),
          curves_(input.mesh, input.labels, limits.samples_per_edge),
          version_(input.mesh.positions.size(), 0) {
        decimater::ModQuadricT<Surface>::Handle quadric;
        decimater::ModNormalDeviationT<Surface>::Handle normal_deviation;
        decimater::ModAspectRatioT<Surface>::Handle aspect_ratio;
        add(quadric);
        add(normal_deviation);
        add(aspect_ratio);
        decimater::ModNormalFlippingT<Surface>::Handle normal_flipping;
        add(normal_flipping);
        module(normal_flipping).set_max_normal_deviation(kMaxTurnDegrees);
        module(quadric).unset_max_err();
        module(normal_deviation).set_normal_deviation(limits.max_angle * 180.0 / M_PI);
        module(aspect_ratio).set_aspect_ratio(static_cast<float>(limits.max_aspect_ratio));
        quadric_ = &module(quadric);
        initialize();
        for (VertexId v = 0; v < input.is_locked.size(); ++v) {
            if (input.is_locked[v] || curves_.is_junction(v)) {
                mesh().status(handle_of(v)).set_locked(true);
            }
        }
        add_samples();
    }

    void run() {
        for (const OpenMesh::VertexHandle vertex : mesh().vertices()) {
            queue_vertex(vertex);
        }
        while (!queue_.empty()) {
            const auto [cost, id, version] = queue_.top();
            queue_.pop();
            const OpenMesh::VertexHandle vertex = handle_of(id);
            if (version != version_[id] || mesh().status(vertex).deleted()) {
                continue;
            }
            for (const Candidate& candidate : candidates(vertex)) {
                if (try_collapse(candidate.half_edge)) {
                    break;
                }
            }
        }
    }

    /// The vertices among the samples of a face that is left.
    std::vector<VertexId> samples_of(OpenMesh::FaceHandle face) const {
        std::vector<VertexId> vertices;
        samples_.for_each(static_cast<TriangleId>(face.idx()), [&](std::size_t sample) {
            if (sample < sampled_vertices_.size()) {
                vertices.push_back(sampled_vertices_[sample]);
            }
        });
        return vertices;
    }

private:
    using HalfEdge = OpenMesh::HalfedgeHandle;

    struct Candidate {
        float cost = 0.0F;
        HalfEdge half_edge;
    };

    /// The samples of faces: vertices, and points within edges where the surface bends.
    void add_samples() {
        constexpr double kFlatCosine = 1.0 - 1e-9;
        for (const OpenMesh::VertexHandle vertex : mesh().vertices()) {
            // One for each label about it.
            std::vector<std::uint32_t> labels;
            for (const OpenMesh::FaceHandle face : mesh().vf_range(vertex)) {
                const auto id = static_cast<TriangleId>(face.idx());
                if (std::find(labels.begin(), labels.end(), input_.labels[id]) == labels.end()) {
                    labels.push_back(input_.labels[id]);
                    samples_.add(id, input_.mesh.positions[id_of(vertex)]);
                    sampled_vertices_.push_back(id_of(vertex));
                }
            }
        }
        for (const OpenMesh::EdgeHandle edge : mesh().edges()) {
            const HalfEdge h = mesh().halfedge_handle(edge, 0);
            const OpenMesh::FaceHandle left = mesh().face_handle(h);
            const OpenMesh::FaceHandle right =
                mesh().face_handle(mesh().opposite_halfedge_handle(h));
            if (!left.is_valid() || !right.is_valid() ||
                (mesh().normal(left) | mesh().normal(right)) > kFlatCosine) {
                continue;
            }
            for_points_within(input_.mesh.positions[id_of(mesh().from_vertex_handle(h))],
                              input_.mesh.positions[id_of(mesh().to_vertex_handle(h))],
                              limits_.max_distance,
                              limits_.samples_per_edge,
                              [&](const Vec3& point) {
                                  samples_.add(static_cast<TriangleId>(left.idx()), point);
                              });
        }
    }

    /// Half-edges from the vertex along which it may be moved as far as curves go, the cheapest
    /// first.
    std::vector<Candidate> candidates(OpenMesh::VertexHandle vertex) {
        std::vector<Candidate> found;
        for (const HalfEdge h : mesh().voh_range(vertex)) {
            const VertexId to = id_of(mesh().to_vertex_handle(h));
            if (!curves_.allows(id_of(vertex), to)) {
                continue;
            }
            const float quadric = quadric_->collapse_priority(CollapseInfo(mesh(), h));
            const double bend = curves_.bend_cost(id_of(vertex), to);
            found.push_back({std::max(0.0F, quadric) + static_cast<float>(bend), h});
        }
        std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
            return std::tuple(a.cost, a.half_edge.idx()) < std::tuple(b.cost, b.half_edge.idx());
        });
        return found;
    }

    void queue_vertex(OpenMesh::VertexHandle vertex) {
        if (mesh().status(vertex).locked()) {
            return;
        }
        const std::vector<Candidate> found = candidates(vertex);
        const VertexId id = id_of(vertex);
        ++version_[id];
        if (!found.empty()) {
            queue_.emplace(found.front().cost, id, version_[id]);
        }
    }

    bool try_collapse(HalfEdge half_edge) {
        CollapseInfo collapse(mesh(), half_edge);
        // The modules answer ILLEGAL_COLLAPSE, -1; rounding may bring a quadric just below 0.
        if (!is_collapse_legal(collapse) || collapse_priority(collapse) < -0.5F ||
            !keeps_distance(collapse)) {
            return false;
        }
        std::vector<OpenMesh::VertexHandle> ring;
        for (const OpenMesh::VertexHandle vertex : mesh().vv_range(collapse.v0)) {
            ring.push_back(vertex);
        }
        preprocess_collapse(collapse);
        mesh().collapse(half_edge);
        for (const OpenMesh::FaceHandle face : mesh().vf_range(collapse.v1)) {
            mesh().set_normal(face, mesh().calc_face_normal(face));
        }
        postprocess_collapse(collapse);
        samples_.move(removed_, moves_);
        curves_.collapse(id_of(collapse.v0), id_of(collapse.v1));
        for (const OpenMesh::VertexHandle vertex : ring) {
            queue_vertex(vertex);
        }
        return true;
    }

    /// Whether all samples about the collapse keep within the distance.
    bool keeps_distance(const CollapseInfo& collapse) {
        if (!curves_.fits(id_of(collapse.v0), id_of(collapse.v1), limits_.max_distance)) {
            return false;
        }
        removed_.clear();
        made_.clear();
        for (const OpenMesh::FaceHandle face : mesh().vf_range(collapse.v0)) {
            const auto id = static_cast<TriangleId>(face.idx());
            removed_.push_back(id);
            if (face == collapse.fl || face == collapse.fr) {
                continue;
            }
            SurfaceSamples::Made made{.element = id, .corners = {}};
            std::size_t corner = 0;
            for (const OpenMesh::VertexHandle vertex : mesh().fv_range(face)) {
                made.corners[corner++] = input_.mesh.positions[id_of(
                    vertex == collapse.v0 ? OpenMesh::VertexHandle(collapse.v1) : vertex)];
            }
            made_.push_back(made);
        }
        return samples_.fits(removed_, made_, limits_.max_distance, moves_);
    }

    const DecimationInput& input_;
    DecimationLimits limits_;
    SurfaceSamples samples_;                  // elements: faces
    std::vector<VertexId> sampled_vertices_;  // of the first samples
    SurfaceCurves curves_;
    decimater::ModQuadricT<Surface>* quadric_ = nullptr;
    std::vector<std::uint32_t> version_;  // per vertex: of its entry that counts
    using Entry = std::tuple<float, VertexId, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
    // Of the collapse at hand.
    std::vector<SurfaceSamples::Element> removed_;
    std::vector<SurfaceSamples::Made> made_;
    SurfaceSamples::Moves moves_;
};

}  // namespace

bool topology_available() noexcept {
    return true;
}

HalfEdgeBorders find_borders(std::span<const Triangle> triangles, std::size_t vertex_count) {
    const Connectivity mesh = connectivity_of(triangles, vertex_count);
    HalfEdgeBorders borders;
    std::vector<bool> is_visited(mesh.n_halfedges(), false);
    for (const OpenMesh::HalfedgeHandle first : mesh.halfedges()) {
        if (!mesh.is_boundary(first) || is_visited[static_cast<std::size_t>(first.idx())]) {
            continue;
        }
        std::vector<HalfEdgeId>& loop = borders.loops.emplace_back();
        OpenMesh::HalfedgeHandle at = first;
        do {
            is_visited[static_cast<std::size_t>(at.idx())] = true;
            loop.push_back(inner_half_edge(mesh, triangles, at));
            at = mesh.next_halfedge_handle(at);
        } while (at != first);
    }
    return borders;
}

std::vector<DecimatedTriangle> decimate(const DecimationInput& input,
                                        const DecimationLimits& limits) {
    Surface surface = surface_of(input.mesh);
    BoundedDecimater decimation(surface, input, limits);
    decimation.run();
    std::vector<DecimatedTriangle> left;
    for (const OpenMesh::FaceHandle face : surface.faces()) {  // leaves out what is deleted
        DecimatedTriangle triangle{.corners = {},
                                   .origin = static_cast<TriangleId>(face.idx()),
                                   .samples = decimation.samples_of(face)};
        std::size_t corner = 0;
        for (const OpenMesh::VertexHandle vertex : surface.fv_range(face)) {
            triangle.corners[corner++] = id_of(vertex);
        }
        left.push_back(triangle);
    }
    return left;
}

}  // namespace earshot::geometry
