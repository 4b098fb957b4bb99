// SPDX-License-Identifier: MIT
#include "earshot/collision/weld.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

namespace earshot::collision {

using geometry::AnimatedMesh;
using geometry::JointWeight;
using geometry::Part;
using geometry::Vec3;
using geometry::VertexId;

namespace {

/// A total order of all doubles, also of those that are not numbers, in which 0 and -0 are equal.
std::uint64_t key_of(double value) noexcept {
    return std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
}

std::strong_ordering compare(const Vec3& a, const Vec3& b) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (const auto order = key_of(a[axis]) <=> key_of(b[axis]); order != 0) {
            return order;
        }
    }
    return std::strong_ordering::equal;
}

/// The vertices of edges that are in one triangle only, ascending.
std::vector<VertexId> border_vertices(std::span<const geometry::Triangle> triangles) {
    std::vector<std::pair<VertexId, VertexId>> edges;
    edges.reserve(3 * triangles.size());
    for (const geometry::Triangle& t : triangles) {
        for (unsigned k = 0; k < 3; ++k) {
            if (t[k] != t[(k + 1) % 3]) {
                edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
            }
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<VertexId> vertices;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool is_shared = (i > 0 && edges[i - 1] == edges[i]) ||
                               (i + 1 < edges.size() && edges[i + 1] == edges[i]);
        if (!is_shared) {
            vertices.push_back(edges[i].first);
            vertices.push_back(edges[i].second);
        }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// For each of `count` vertices the first on a border that compares equal to it, if it is on one.
template <typename Compare>
std::vector<VertexId> first_equal(std::size_t count,
                                  std::span<const geometry::Triangle> triangles,
                                  const Compare& compare_vertices) {
    std::vector<VertexId> order = border_vertices(triangles);
    std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
        const std::strong_ordering result = compare_vertices(a, b);
        return result != 0 ? result < 0 : a < b;
    });
    std::vector<VertexId> first(count);
    std::iota(first.begin(), first.end(), VertexId{0});
    for (std::size_t i = 1; i < order.size(); ++i) {
        if (compare_vertices(order[i - 1], order[i]) == 0) {
            first[order[i]] = first[order[i - 1]];
        }
    }
    return first;
}

bool are_equal(const geometry::Track& a, const geometry::Track& b) {
    return a.interpolation == b.interpolation && a.times == b.times && a.values == b.values;
}

/// Whether equal vertices of two parts of one mesh move alike.
bool move_alike(const Part& a, const Part& b) {
    return a.node == b.node && a.node >= 0 && a.skin == b.skin &&
           a.targets.size() == b.targets.size() &&
           (a.targets.empty() ||
            (a.rest_weights == b.rest_weights && are_equal(a.weights, b.weights)));
}

/// Vertices of an animated mesh by everything that decides where they are.
class MovingVertices {
public:
    explicit MovingVertices(const AnimatedMesh& mesh) : mesh_(mesh) {
        const std::vector<Part>& parts = mesh.parts();
        for (std::uint32_t part = 0; part < parts.size(); ++part) {
            first_.push_back(static_cast<VertexId>(part_of_.size()));
            part_of_.insert(part_of_.end(), parts[part].positions.size(), part);
            // Parts of one node follow each other.
            const bool continues = part > 0 && move_alike(parts[part - 1], parts[part]);
            motion_of_part_.push_back(continues ? motion_of_part_.back() : part);
        }
    }

    std::strong_ordering operator()(VertexId a, VertexId b) const {
        const std::uint32_t part_a = part_of_[a];
        const std::uint32_t part_b = part_of_[b];
        if (const auto order = mesh_.mesh_of_vertex()[a] <=> mesh_.mesh_of_vertex()[b];
            order != 0) {
            return order;
        }
        if (const auto order = motion_of_part_[part_a] <=> motion_of_part_[part_b]; order != 0) {
            return order;
        }
        const Part& one = mesh_.parts()[part_a];
        const Part& other = mesh_.parts()[part_b];
        const std::size_t i = a - first_[part_a];
        const std::size_t k = b - first_[part_b];
        if (const auto order = compare(one.positions[i], other.positions[k]); order != 0) {
            return order;
        }
        for (std::size_t target = 0; target < one.targets.size(); ++target) {
            const auto order =
                compare(one.targets[target].displacement[i], other.targets[target].displacement[k]);
            if (order != 0) {
                return order;
            }
        }
        return compare_influences(one, i, other, k);
    }

private:
    /// Joints without weight do not count.
    static std::strong_ordering compare_influences(const Part& one,
                                                   std::size_t i,
                                                   const Part& other,
                                                   std::size_t k) {
        const auto next = [](const Part& part, std::size_t vertex, std::size_t& at) {
            const std::size_t first = vertex * part.influences_per_vertex;
            while (at < part.influences_per_vertex && part.influences[first + at].weight == 0.0) {
                ++at;
            }
            return at < part.influences_per_vertex ? &part.influences[first + at++] : nullptr;
        };
        for (std::size_t at_one = 0, at_other = 0;;) {
            const JointWeight* a = next(one, i, at_one);
            const JointWeight* b = next(other, k, at_other);
            if (a == nullptr || b == nullptr) {
                return (a != nullptr) <=> (b != nullptr);
            }
            if (const auto order = a->joint <=> b->joint; order != 0) {
                return order;
            }
            if (const auto order = key_of(a->weight) <=> key_of(b->weight); order != 0) {
                return order;
            }
        }
    }

    const AnimatedMesh& mesh_;
    std::vector<VertexId> first_;  // of each part
    std::vector<std::uint32_t> part_of_, motion_of_part_;
};

}  // namespace

std::vector<VertexId> weld(std::span<const geometry::Triangle> triangles,
                           std::span<const std::vector<Vec3>> poses) {
    const std::size_t count = poses.empty() ? 0 : poses.front().size();
    return first_equal(count, triangles, [&](VertexId a, VertexId b) {
        for (const std::vector<Vec3>& pose : poses) {
            EARSHOT_ASSERT(pose.size() == count);
            if (const auto order = compare(pose[a], pose[b]); order != 0) {
                return order;
            }
        }
        return std::strong_ordering::equal;
    });
}

std::vector<VertexId> weld(const AnimatedMesh& mesh) {
    return first_equal(mesh.vertex_count(), mesh.triangles(), MovingVertices(mesh));
}

void replace_vertices(std::span<geometry::Triangle> triangles,
                      std::span<const VertexId> representatives) noexcept {
    for (geometry::Triangle& triangle : triangles) {
        for (VertexId& vertex : triangle) {
            vertex = representatives[vertex];
        }
    }
}

}  // namespace earshot::collision
