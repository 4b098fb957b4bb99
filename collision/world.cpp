// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/discrete.h"
#include "earshot/collision/internal/elements.h"
#include "earshot/collision/internal/motion_slabs.h"
#include "earshot/collision/internal/swept_pairs.h"
#include "earshot/collision/moving_points.h"
#include "earshot/collision/separation.h"
#include "earshot/collision/triangle_pair.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

/// A refitted tree is kept until its cost has grown by this factor.
constexpr double kRebuildAtCost = 1.5;

bool share_a_vertex(std::span<const VertexId> a, std::span<const VertexId> b) {
    return std::any_of(a.begin(), a.end(), [&](VertexId vertex) {
        return std::find(b.begin(), b.end(), vertex) != b.end();
    });
}

Vec3 unit(const Vec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : Vec3(0.0);
}

/// The first three slabs are the axes'.
geometry::Aabb swept_box(const MotionSlabs& slabs) {
    geometry::Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(slabs.lower_begin[axis], slabs.lower_end[axis]);
        box.upper[axis] = std::max(slabs.upper_begin[axis], slabs.upper_end[axis]);
    }
    return box;
}

}  // namespace

/// Vertices of all meshes one after the other; triangles likewise.
struct World::State {
    std::vector<Vec3> begin, end;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> mesh_of_triangle;
    std::vector<std::uint8_t> own;       // see own_elements()
    std::vector<VertexId> first_vertex;  // of each mesh
    std::vector<geometry::Aabb> boxes;   // swept triangles
    std::vector<MotionSlabs> slabs;      // likewise
    bvh::Tree tree;
    double cost_when_built = 0.0;
    bool has_new_meshes = false;
    std::vector<std::size_t> first_triangle;  // of each mesh
    WorldStatistics statistics;

    geometry::MeshView mesh_at_begin(std::uint32_t mesh) const;
    Contact contact_at_begin(std::uint32_t mesh_a, std::uint32_t mesh_b, TrianglePair pair) const;
    void update_tree(double margin, Executor& executor);
    bool is_wanted(std::uint32_t a, std::uint32_t b, const ContactOptions& options) const;
    MovingCorners corners_of(std::uint32_t triangle) const;
    MovingPoints points_of(const std::array<VertexId, 4>& vertices) const;
    Element element(std::uint32_t mesh, std::span<const VertexId> vertices) const;
    void complete(const std::array<VertexId, 4>& vertices, Contact& contact) const;
};

namespace {

/// What one part of the search found.
struct Findings {
    std::vector<Contact> contacts;
    WorldStatistics statistics;
};

/// Tests the elements of triangles against each other.
template <class State>
class ElementTester {
public:
    ElementTester(const State& state, const ContactOptions& options, Findings& findings)
        : state_(state), options_(options), findings_(findings) {}

    void test(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t mesh_a = state_.mesh_of_triangle[a];
        const std::uint32_t mesh_b = state_.mesh_of_triangle[b];
        if (!state_.is_wanted(mesh_a, mesh_b, options_)) {
            return;
        }
        ++findings_.statistics.triangle_pairs;
        if (are_apart(state_.slabs[a], state_.slabs[b])) {
            return;
        }
        // Neighbours touch where they meet: no plane is between them.
        if (!share_a_vertex(state_.triangles[a], state_.triangles[b])) {
            const MovingCorners one = state_.corners_of(a);
            const MovingCorners other = state_.corners_of(b);
            if (are_apart_along_normal(one, other, options_.margin()) ||
                are_apart_along_normal(other, one, options_.margin())) {
                return;
            }
        }
        test_elements(a, b);
    }

private:
    void test_elements(std::uint32_t a, std::uint32_t b) {
        test_corners(a, b);
        test_corners(b, a);
        for (unsigned i = 0; i < 3; ++i) {
            for (unsigned k = 0; k < 3; ++k) {
                if ((state_.own[a] >> (3 + i) & state_.own[b] >> (3 + k) & 1) != 0) {
                    test_edges(a, i, b, k);
                }
            }
        }
    }

    void test_corners(std::uint32_t of, std::uint32_t face) {
        const Triangle& corners = state_.triangles[face];
        for (unsigned i = 0; i < 3; ++i) {
            const VertexId vertex = state_.triangles[of][i];
            if ((state_.own[of] >> i & 1) == 0 || share_a_vertex(std::span(&vertex, 1), corners)) {
                continue;
            }
            ++findings_.statistics.elementary_tests;
            // Ascending, so that the time does not depend on how the triangle is written.
            std::array<VertexId, 4> vertices{vertex, corners[0], corners[1], corners[2]};
            std::sort(vertices.begin() + 1, vertices.end());
            const MovingPoints points = state_.points_of(vertices);
            const auto time = options_.least_separation > 0.0
                                  ? vertex_face_time_within(points, separation())
                                  : vertex_face_time(points);
            if (time) {
                Contact contact{
                    .kind = ContactKind::vertex_face,
                    .a = state_.element(state_.mesh_of_triangle[of], std::span(vertices).first(1)),
                    .b = state_.element(state_.mesh_of_triangle[face], std::span(vertices).last(3)),
                    .toi = *time};
                state_.complete(vertices, contact);
                findings_.contacts.push_back(contact);
            }
        }
    }

    void test_edges(std::uint32_t a, unsigned i, std::uint32_t b, unsigned k) {
        std::array<VertexId, 4> vertices{state_.triangles[a][i],
                                         state_.triangles[a][(i + 1) % 3],
                                         state_.triangles[b][k],
                                         state_.triangles[b][(k + 1) % 3]};
        if (share_a_vertex(std::span(vertices).first(2), std::span(vertices).last(2))) {
            return;
        }
        ++findings_.statistics.elementary_tests;
        // In the order of the elements, so that the time does not depend on the triangles: vertices
        // of later meshes come later.
        std::sort(vertices.begin(), vertices.begin() + 2);
        std::sort(vertices.begin() + 2, vertices.end());
        if (std::pair(vertices[2], vertices[3]) < std::pair(vertices[0], vertices[1])) {
            std::rotate(vertices.begin(), vertices.begin() + 2, vertices.end());
            std::swap(a, b);
        }
        const MovingPoints points = state_.points_of(vertices);
        const auto time = options_.least_separation > 0.0
                              ? edge_edge_time_within(points, separation())
                              : edge_edge_time(points);
        if (time) {
            Contact contact{
                .kind = ContactKind::edge_edge,
                .a = state_.element(state_.mesh_of_triangle[a], std::span(vertices).first(2)),
                .b = state_.element(state_.mesh_of_triangle[b], std::span(vertices).last(2)),
                .toi = *time};
            state_.complete(vertices, contact);
            findings_.contacts.push_back(contact);
        }
    }

    SeparationOptions separation() const {
        return {.least_separation = options_.least_separation, .tolerance = options_.tolerance};
    }

    const State& state_;
    const ContactOptions& options_;
    Findings& findings_;
};

}  // namespace

void World::State::update_tree(double margin, Executor& executor) {
    boxes.resize(triangles.size());
    slabs.resize(triangles.size());
    executor.for_each(triangles.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const MovingCorners corners = corners_of(static_cast<std::uint32_t>(i));
            slabs[i] = MotionSlabs(corners.begin, corners.end, margin);
            boxes[i] = swept_box(slabs[i]);
        }
    });
    if (!has_new_meshes) {
        tree.refit(boxes, executor);
        if (bvh::sah_cost(tree) <= kRebuildAtCost * cost_when_built) {
            return;
        }
    }
    tree = bvh::Tree::build(boxes, {}, executor);
    cost_when_built = bvh::sah_cost(tree);
    has_new_meshes = false;
}

bool World::State::is_wanted(std::uint32_t a,
                             std::uint32_t b,
                             const ContactOptions& options) const {
    return (a == b ? options.within_meshes : options.between_meshes) &&
           (!options.filter || options.filter(std::min(a, b), std::max(a, b)));
}

MovingCorners World::State::corners_of(std::uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {{begin[t[0]], begin[t[1]], begin[t[2]]}, {end[t[0]], end[t[1]], end[t[2]]}};
}

MovingPoints World::State::points_of(const std::array<VertexId, 4>& vertices) const {
    MovingPoints points;
    for (std::size_t i = 0; i < 4; ++i) {
        points.begin[i] = begin[vertices[i]];
        points.end[i] = end[vertices[i]];
    }
    return points;
}

Element World::State::element(std::uint32_t mesh, std::span<const VertexId> vertices) const {
    Element element{.mesh = mesh, .size = static_cast<std::uint32_t>(vertices.size())};
    std::copy(vertices.begin(), vertices.end(), element.vertices.begin());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        element.vertices[i] -= first_vertex[mesh];
    }
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        for (std::size_t k = i; k > 0 && element.vertices[k] < element.vertices[k - 1]; --k) {
            std::swap(element.vertices[k], element.vertices[k - 1]);
        }
    }
    return element;
}

void World::State::complete(const std::array<VertexId, 4>& vertices, Contact& contact) const {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = begin[vertices[i]] + contact.toi * (end[vertices[i]] - begin[vertices[i]]);
    }
    Vec3 from_b;  // to a, at the beginning
    if (contact.kind == ContactKind::vertex_face) {
        contact.point = x[0];
        contact.normal = unit(glm::cross(x[2] - x[1], x[3] - x[1]));
        from_b = begin[vertices[0]] - begin[vertices[1]];
    } else {
        const Vec3 along = x[1] - x[0];
        const Vec3 normal = glm::cross(along, x[3] - x[2]);
        contact.normal = unit(normal);
        // a + u (b - a) on the plane of the other edge and the normal.
        const double area = glm::dot(normal, normal);
        const double share =
            area > 0.0 ? glm::dot(glm::cross(x[2] - x[0], x[3] - x[2]), normal) / area : 0.5;
        contact.point = x[0] + std::clamp(share, 0.0, 1.0) * along;
        from_b = begin[vertices[0]] - begin[vertices[2]];
    }
    if (glm::dot(contact.normal, from_b) < 0.0) {
        contact.normal = -contact.normal;
    }
}

geometry::MeshView World::State::mesh_at_begin(std::uint32_t mesh) const {
    const std::size_t from = first_triangle[mesh];
    const std::size_t to =
        mesh + 1 < first_triangle.size() ? first_triangle[mesh + 1] : triangles.size();
    return {begin, std::span(triangles).subspan(from, to - from)};
}

Contact World::State::contact_at_begin(std::uint32_t mesh_a,
                                       std::uint32_t mesh_b,
                                       TrianglePair pair) const {
    const Triangle& a = triangles[first_triangle[mesh_a] + pair.a];
    const Triangle& b = triangles[first_triangle[mesh_b] + pair.b];
    const Corners one{begin[a[0]], begin[a[1]], begin[a[2]]};
    const Corners other{begin[b[0]], begin[b[1]], begin[b[2]]};
    Contact contact{
        .kind = ContactKind::triangle_triangle, .a = element(mesh_a, a), .b = element(mesh_b, b)};
    if (const auto segment = intersection(one, other)) {
        contact.point = 0.5 * (segment->from + segment->to);
    }
    contact.normal = unit(glm::cross(other[1] - other[0], other[2] - other[0]));
    if (glm::dot(contact.normal, (one[0] + one[1] + one[2]) / 3.0 - other[0]) < 0.0) {
        contact.normal = -contact.normal;
    }
    return contact;
}

World::World() : state_(std::make_unique<State>()) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::uint32_t World::add_mesh(std::span<const Triangle> triangles, std::size_t vertices) {
    State& state = *state_;
    const auto first = static_cast<VertexId>(state.begin.size());
    const auto mesh = static_cast<std::uint32_t>(state.first_vertex.size());
    for (const Triangle& triangle : triangles) {
        for (const VertexId vertex : triangle) {
            if (vertex >= vertices) {
                throw Error("mesh " + std::to_string(mesh),
                            "a triangle names vertex " + std::to_string(vertex) + " of " +
                                std::to_string(vertices),
                            "check the indices");
            }
        }
    }
    for (const Triangle& triangle : triangles) {
        state.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
    const auto own = own_elements(triangles);
    state.own.insert(state.own.end(), own.begin(), own.end());
    state.mesh_of_triangle.resize(state.triangles.size(), mesh);
    state.first_vertex.push_back(first);
    state.first_triangle.push_back(state.triangles.size() - triangles.size());
    state.begin.resize(first + vertices, Vec3(0.0));
    state.end.resize(first + vertices, Vec3(0.0));
    state.has_new_meshes = true;
    return mesh;
}

void World::update(std::uint32_t mesh, std::span<const Vec3> begin, std::span<const Vec3> end) {
    EARSHOT_ASSERT(mesh < state_->first_vertex.size() && begin.size() == end.size());
    const auto is_finite = [](const Vec3& point) {
        return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
    };
    if (!std::all_of(begin.begin(), begin.end(), is_finite) ||
        !std::all_of(end.begin(), end.end(), is_finite)) {
        throw Error(
            "mesh " + std::to_string(mesh), "a position is not finite", "check the positions");
    }
    const auto first = static_cast<std::ptrdiff_t>(state_->first_vertex[mesh]);
    EARSHOT_ASSERT(static_cast<std::size_t>(first) + begin.size() <= state_->begin.size());
    std::copy(begin.begin(), begin.end(), state_->begin.begin() + first);
    std::copy(end.begin(), end.end(), state_->end.begin() + first);
}

std::vector<Contact> World::contacts(const ContactOptions& options, Executor& executor) {
    State& state = *state_;
    state.statistics = {};
    if (state.triangles.empty()) {
        return {};
    }
    state.update_tree(options.margin(), executor);
    const PairSearch search(state.tree, state.boxes);
    std::vector<Findings> findings(search.parts());
    executor.for_each(search.parts(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t part = from; part < to; ++part) {
            ElementTester<State> tester(state, options, findings[part]);
            findings[part].statistics.box_tests += search.for_each_pair(
                part, [&](std::uint32_t a, std::uint32_t b) { tester.test(a, b); });
        }
    });
    std::vector<Contact> contacts;
    for (const Findings& part : findings) {
        contacts.insert(contacts.end(), part.contacts.begin(), part.contacts.end());
        state.statistics.box_tests += part.statistics.box_tests;
        state.statistics.triangle_pairs += part.statistics.triangle_pairs;
        state.statistics.elementary_tests += part.statistics.elementary_tests;
    }
    std::sort(contacts.begin(), contacts.end());
    // Triangles that stand twice in a mesh give the same contact.
    const auto last =
        std::unique(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
            return x.kind == y.kind && x.a == y.a && x.b == y.b;
        });
    contacts.erase(last, contacts.end());
    return contacts;
}

std::vector<Contact> World::contacts_at_begin(const ContactOptions& options,
                                              Executor& executor) const {
    const State& state = *state_;
    const auto meshes = static_cast<std::uint32_t>(state.first_vertex.size());
    std::vector<Shape> shapes;
    for (std::uint32_t mesh = 0; mesh < meshes; ++mesh) {
        shapes.push_back(Shape::build(state.mesh_at_begin(mesh), {}, executor));
    }
    std::vector<Contact> contacts;
    for (std::uint32_t a = 0; a < meshes; ++a) {
        for (std::uint32_t b = a; b < meshes; ++b) {
            if (!state.is_wanted(a, b, options)) {
                continue;
            }
            const auto pairs = a == b ? find_self_contacts({shapes[a]}, executor)
                                      : find_contacts({shapes[a]}, {shapes[b]}, executor);
            for (const TrianglePair& pair : pairs) {
                contacts.push_back(state.contact_at_begin(a, b, pair));
                if (contacts.back().b < contacts.back().a) {
                    std::swap(contacts.back().a, contacts.back().b);
                }
            }
        }
    }
    std::sort(contacts.begin(), contacts.end());
    return contacts;
}

std::optional<Contact> World::first_contact(const ContactOptions& options, Executor& executor) {
    const std::vector<Contact> all = contacts(options, executor);
    return all.empty() ? std::nullopt : std::optional(all.front());
}

const WorldStatistics& World::statistics() const noexcept {
    return state_->statistics;
}

}  // namespace earshot::collision
