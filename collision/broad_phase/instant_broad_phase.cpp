// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/instant_broad_phase.h"

#include <glm/common.hpp>

#include <algorithm>
#include <limits>

namespace earshot::collision {

namespace {

// Larger meshes are updated one after another, each in parallel; smaller ones next to each other.
constexpr std::size_t kLargeMesh = 16384;
constexpr std::size_t kMeshGrain = 16;

// A mesh that has come to rest is updated some more times, so that a tree that queries find costly
// is repaired. What they cost in excess per instant is less than an update afterwards: in so many
// instants it has not added up to what a rebuild costs, some 20 visits per triangle, and an update
// costs 7.
constexpr int kInstantsToSettle = 8;

// Eight boxes of a node are tested against another box in the time of about two node visits.
constexpr double kVisitsPerBoxTest = 0.25;
constexpr double kVisitsPerTrianglePair = 2.0;

/// Precondition: the mesh has triangles.
geometry::Aabb bounds_of(const MovingScene& scene, std::uint32_t mesh) {
    const std::span<const geometry::Triangle> triangles = scene.triangles_of(mesh);
    geometry::Vec3 lower = scene.begin[triangles[0][0]];
    geometry::Vec3 upper = lower;
    for (const geometry::Triangle& triangle : triangles) {
        for (const geometry::VertexId vertex : triangle) {
            lower = glm::min(lower, scene.begin[vertex]);
            upper = glm::max(upper, scene.begin[vertex]);
        }
    }
    geometry::Aabb bounds;
    bounds.include(lower);
    bounds.include(upper);
    return bounds;
}

/// Lists the pairs of meshes in the leaves of the upper tree: the tester of its traversal.
class MeshPairLister {
public:
    MeshPairLister(const bvh::Tree& tree,
                   std::span<const std::uint32_t> present,
                   const ContactOptions& options)
        : tree_(&tree), present_(present), options_(&options) {}

    // NOLINTNEXTLINE(readability-convert-member-functions-to-static): a tester's method
    bool culls(std::uint32_t, std::uint32_t) const noexcept { return false; }

    std::uint64_t test_leaves(std::uint32_t node_a, std::uint32_t node_b) {
        const auto [a, b] = std::minmax({mesh_of(node_a), mesh_of(node_b)});
        if (options_->accepts(a, b)) {
            pairs.push_back({a, b});
        }
        return 0;
    }

    std::vector<MeshPair> pairs;

private:
    std::uint32_t mesh_of(std::uint32_t leaf) const noexcept {
        return present_[tree_->primitives()[tree_->nodes()[leaf].first]];
    }

    const bvh::Tree* tree_;
    std::span<const std::uint32_t> present_;
    const ContactOptions* options_;
};

}  // namespace

void InstantBroadPhase::note_update(std::uint32_t mesh, bool has_moved) {
    if (mesh >= kept_.size()) {
        return;  // it was added since the last search
    }
    KeptMesh& kept = kept_[mesh];
    if (has_moved) {
        ++kept.pose;
        kept.are_bounds_current = false;
        kept.instants_to_settle = kInstantsToSettle;
    } else if (kept.instants_to_settle > 0) {
        --kept.instants_to_settle;
    } else {
        return;
    }
    kept.is_shape_current = false;
    is_upper_current_ = false;
}

/// Shapes hold views of arrays that move when meshes are added or removed.
void InstantBroadPhase::follow_layout(const MovingScene& scene) {
    if (layout_ == scene.layout) {
        return;
    }
    layout_ = scene.layout;
    kept_.resize(scene.meshes());
    present_.clear();
    for (std::uint32_t mesh = 0; mesh < kept_.size(); ++mesh) {
        kept_[mesh].is_shape_current = false;
        if (scene.is_removed[mesh] != 0) {
            kept_[mesh] = {};
        }
        if (!scene.triangles_of(mesh).empty()) {
            present_.push_back(mesh);
        }
    }
    is_upper_current_ = false;
    version_ = 0;
}

void InstantBroadPhase::update_upper_tree(const MovingScene& scene,
                                          Executor& executor,
                                          WorldStatistics& statistics) {
    follow_layout(scene);
    if (is_upper_current_) {
        return;
    }
    std::vector<geometry::Aabb> boxes(present_.size());
    executor.for_each(boxes.size(), kMeshGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            KeptMesh& mesh = kept_[present_[i]];
            if (!mesh.are_bounds_current) {
                mesh.bounds = bounds_of(scene, present_[i]);
                mesh.are_bounds_current = true;
            }
            boxes[i] = mesh.bounds;
        }
    });
    if (version_ == 0) {
        upper_ = bvh::DeformableBvh(
            boxes,
            {.build = {.max_leaf_size = 1}, .queries_per_update = 0.0},  // until a search has told
            executor);
    } else {
        statistics.updates.count(upper_.update(boxes, executor).action);
    }
    if (version_ != upper_.version()) {
        version_ = upper_.version();
        front_.reset();
    }
    is_upper_current_ = true;
}

std::vector<MeshPair> InstantBroadPhase::mesh_pairs(const MovingScene& scene,
                                                    const ContactOptions& options,
                                                    Executor& executor,
                                                    WorldStatistics& statistics) {
    update_upper_tree(scene, executor, statistics);
    std::vector<MeshPair> pairs;
    const bvh::Tree& tree = upper_.binary_tree();
    const std::uint64_t box_tests = front_.traverse(
        tree,
        options.track_front,
        std::numeric_limits<std::size_t>::max(),
        executor,
        [&] { return MeshPairLister(tree, present_, options); },
        [&](const MeshPairLister& lister) {
            pairs.insert(pairs.end(), lister.pairs.begin(), lister.pairs.end());
        });
    upper_.expect_node_visits(static_cast<double>(box_tests));
    statistics.box_tests += box_tests;
    statistics.front_nodes += front_.size();
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

void InstantBroadPhase::update_shape(const MovingScene& scene,
                                     std::uint32_t mesh,
                                     Executor& executor,
                                     WorldStatistics& statistics) {
    KeptMesh& kept = kept_[mesh];
    const geometry::MeshView view{scene.begin, scene.triangles_of(mesh)};
    if (!kept.has_shape) {
        kept.shape = Shape::build(view, {.builder = builder_}, executor);
        kept.has_shape = true;
        kept.instants_to_settle = 0;
    } else if (!kept.is_shape_current) {
        kept.shape.expect_node_visits(kept.node_visits);
        statistics.updates.count(kept.shape.update(view, executor).action);
        kept.node_visits = 0.0;
    }
    kept.is_shape_current = true;
}

void InstantBroadPhase::update_shapes(const MovingScene& scene,
                                      std::span<const std::uint32_t> meshes,
                                      Executor& executor,
                                      WorldStatistics& statistics) {
    follow_layout(scene);
    const auto is_large = [&](std::uint32_t mesh) {
        return scene.triangles_of(mesh).size() >= kLargeMesh;
    };
    for (const std::uint32_t mesh : meshes) {
        if (is_large(mesh)) {
            update_shape(scene, mesh, executor, statistics);
        }
    }
    std::vector<WorldStatistics> of_chunk(chunk_count(meshes.size(), kMeshGrain));
    executor.for_each(meshes.size(), kMeshGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!is_large(meshes[i])) {
                update_shape(scene, meshes[i], Executor::serial(), of_chunk[begin / kMeshGrain]);
            }
        }
    });
    for (const WorldStatistics& each : of_chunk) {
        statistics += each;
    }
}

void InstantBroadPhase::add_work(std::uint32_t mesh, const WorldStatistics& work) noexcept {
    kept_[mesh].node_visits += kVisitsPerBoxTest * static_cast<double>(work.box_tests) +
                               kVisitsPerTrianglePair * static_cast<double>(work.triangle_pairs);
}

}  // namespace earshot::collision
