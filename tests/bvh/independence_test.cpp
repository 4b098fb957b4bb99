// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/builder_names.h"
#include "earshot/bvh/ray.h"
#include "earshot/bvh/reinsertion.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <gtest/gtest.h>

#include "support/bunny.h"
#include "support/meshes.h"
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Hit;
using geometry::Mesh;
using geometry::MeshView;
using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

struct Question {
    Ray ray;
    Segment segment;
};

/// Rays and segments about a mesh, alone and in packets: through it, at its vertices, from its
/// surface, along axes, and with ends short of and beyond what they aim at.
std::vector<Question> questions_about(const Mesh& mesh, std::uint64_t seed, std::size_t count) {
    std::vector<Question> questions;
    const auto point = [&](std::uint64_t i) {
        const auto& [p, q, r] = mesh.triangles[random_bits(seed, 0, i) % mesh.triangles.size()];
        const Vec3& a = mesh.positions[p];
        return i % 3 == 0 ? a
                          : a + 0.7 * random(seed, 1, i) * (mesh.positions[q] - a) +
                                0.3 * random(seed, 2, i) * (mesh.positions[r] - a);
    };
    for (std::uint64_t i = 0; i < count; ++i) {
        // Of every eighty the first forty look from one point at one place, as a camera does.
        const bool is_packet = i % 80 < 40;
        const std::uint64_t about = is_packet ? i / 80 * 80 : i;
        const Vec3 other = point(2 * about + 1);
        const Vec3 place = point(2 * about);
        const Vec3 target =
            is_packet ? place + 0.02 * glm::distance(place, other) * test::random_point(seed + 2, i)
                      : place;
        const Vec3 aside = glm::distance(place, other) * test::random_point(seed + 1, about);
        const Vec3 origin = about % 4 == 1 ? other : other + aside;
        Ray ray{.origin = origin, .direction = target - origin};
        if (i % 5 == 0 && !is_packet) {
            ray.direction[static_cast<int>(i % 3)] = 0.0;
        }
        if (i % 7 == 0) {
            ray.t_max = 2.0 * random(seed, 3, i);
        }
        const double beyond = i % 2 == 0 ? 1.0 : random(seed, 4, i);
        questions.push_back({ray, {origin, origin + beyond * (target - origin)}});
    }
    return questions;
}

struct Answer {
    std::optional<Hit> hit;
    bool is_occluded = false;
    friend bool operator==(const Answer&, const Answer&) = default;
};

std::vector<Answer> ask(const Tree& tree, const MeshView& mesh, std::span<const Question> all) {
    std::vector<Answer> answers;
    for (const Question& question : all) {
        answers.push_back(
            {closest_hit(tree, mesh, question.ray), occluded(tree, mesh, question.segment)});
    }
    return answers;
}

std::vector<Answer> ask(const WideTree& tree, const MeshView& mesh, std::span<const Question> all) {
    std::vector<Answer> answers;
    for (const Question& question : all) {
        answers.push_back(
            {closest_hit(tree, mesh, question.ray), occluded(tree, mesh, question.segment)});
    }
    return answers;
}

std::vector<Answer> ask_in_batches(const WideTree& tree,
                                   const MeshView& mesh,
                                   std::span<const Question> all,
                                   Executor& executor) {
    std::vector<Ray> rays;
    std::vector<Segment> segments;
    for (const Question& question : all) {
        rays.push_back(question.ray);
        segments.push_back(question.segment);
    }
    const auto hits = closest_hits(tree, mesh, rays, executor);
    const auto blocked = occluded(tree, mesh, segments, executor);
    std::vector<Answer> answers;
    for (std::size_t i = 0; i < all.size(); ++i) {
        answers.push_back({hits[i], blocked[i] == 1});
    }
    return answers;
}

/// Asks a wide tree ray by ray and in batches, with every instruction set of the machine.
void expect_from_wide(const WideTree& wide,
                      const MeshView& mesh,
                      std::span<const Question> questions,
                      const std::vector<Answer>& expected,
                      Executor& executor) {
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(ask(wide, mesh, questions), expected) << target;
        EXPECT_EQ(ask_in_batches(wide, mesh, questions, executor), expected) << target;
    }
    override_simd_target("auto");
}

std::vector<Answer> ask_every_triangle(const MeshView& mesh, std::span<const Question> all) {
    std::vector<Answer> answers;
    for (const Question& question : all) {
        answers.push_back({brute_force::closest_hit(mesh, question.ray),
                           brute_force::occluded(mesh, question.segment)});
    }
    return answers;
}

/// Moves the vertices over a few frames and asks trees of all leaf sizes, refitted since the first
/// frame, then repaired, and rebuilt by every builder with 1, 2 and 8 threads; binary and wide.
void expect_one_answer(const Mesh& rest, double size, std::size_t count, std::size_t by_force) {
    constexpr std::array<int, 3> kLeafSizes = {1, 4, 15};
    constexpr std::array<int, 3> kThreads = {1, 2, 8};
    std::vector<Tree> refitted;
    std::vector<WideTree> refitted_wide, refitted_quantised;
    for (const int max_leaf_size : kLeafSizes) {
        refitted.push_back(
            Tree::build(triangle_boxes(rest.view()), {.max_leaf_size = max_leaf_size}));
        refitted_wide.push_back(WideTree::build(refitted.back(), rest.view()));
        refitted_quantised.push_back(WideTree::build(
            refitted.back(), rest.view(), Executor::serial(), LeafEncoding::quantised));
    }
    Mesh mesh = rest;
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            mesh.positions[i] += frame == 0 ? Vec3(0.0) : size * test::random_point(frame, i);
        }
        const auto questions = questions_about(mesh, 100 + frame, count);
        const auto boxes = triangle_boxes(mesh.view());
        const auto expected = ask(Tree::build(boxes), mesh.view(), questions);
        const std::span<const Question> few(questions.data(), by_force);
        const auto forced = ask_every_triangle(mesh.view(), few);
        ASSERT_TRUE(std::equal(forced.begin(), forced.end(), expected.begin())) << frame;
        for (std::size_t k = 0; k < kThreads.size(); ++k) {
            Executor executor(kThreads[k]);
            for (const NamedBuilder& named : named_builders()) {
                const BuildOptions options{.builder = named.builder,
                                           .max_leaf_size = kLeafSizes[k]};
                const Tree rebuilt = Tree::build(boxes, options, executor);
                ASSERT_EQ(ask(rebuilt, mesh.view(), questions), expected)
                    << frame << ' ' << k << ' ' << named.name;
                if (k == frame) {
                    SCOPED_TRACE(named.name);
                    const auto wide = WideTree::build(rebuilt, mesh.view(), executor);
                    expect_from_wide(wide, mesh.view(), questions, expected, executor);
                }
            }
            refitted[k].refit(boxes, executor);
            ASSERT_EQ(ask(refitted[k], mesh.view(), questions), expected) << frame << ' ' << k;
            for (WideTree* wide : {&refitted_wide[k], &refitted_quantised[k]}) {
                wide->refit(mesh.view(), executor);
                expect_from_wide(*wide, mesh.view(), questions, expected, executor);
            }
            Tree repaired = refitted[k];
            optimise_by_reinsertion(
                repaired, {.max_iterations = 3, .batch_size_ratio = 0.1}, executor);
            ASSERT_EQ(ask(repaired, mesh.view(), questions), expected) << frame << ' ' << k;
            const auto wide = WideTree::build(repaired, mesh.view(), executor);
            expect_from_wide(wide, mesh.view(), questions, expected, executor);
        }
        std::size_t hits = 0, misses = 0, blocked = 0;
        for (const Answer& answer : expected) {
            ++(answer.hit ? hits : misses);
            blocked += answer.is_occluded ? 1 : 0;
        }
        EXPECT_GT(hits, count / 10);
        EXPECT_GT(misses, count / 50);
        EXPECT_GT(blocked, count / 10);
        EXPECT_LT(blocked, count);
    }
}

TEST(Independence, AnswersDoNotDependOnTheTreeOfASoup) {
    expect_one_answer(test::triangle_soup(1, 2000), 0.2, 2000, 300);
}

TEST(Independence, AnswersDoNotDependOnTheTreeOfAGrid) {
    // Whole walls of triangles in one plane: ties in distance, boxes without depth.
    expect_one_answer(test::cube(15, 0.3), 0.0, 2000, 300);
    expect_one_answer(test::cube(15, 0.3), 0.03, 2000, 300);
}

TEST(Independence, AnswersDoNotDependOnTheTreeOfAScannedMesh) {
    const Mesh bunny = test::stanford_bunny();
    if (bunny.triangles.empty()) {
        GTEST_SKIP();
    }
    expect_one_answer(bunny, 0.01, 1000, 10);
}

/// Many rays in batches: every builder's tree, fresh, refitted over twenty frames, and repaired,
/// with threads and instruction sets in turn.
void expect_one_answer_to_many(const Mesh& rest, double step, std::size_t count) {
    constexpr std::array<int, 3> kThreads = {1, 2, 8};
    std::vector<Tree> trees;
    std::vector<WideTree> refitted;
    for (const NamedBuilder& named : named_builders()) {
        trees.push_back(Tree::build(triangle_boxes(rest.view()), {.builder = named.builder}));
        refitted.push_back(WideTree::build(trees.back(), rest.view()));
    }
    Mesh mesh = rest;
    for (std::uint64_t frame = 0; frame < 20; ++frame) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            mesh.positions[i] += step * test::random_point(frame, i);
        }
        for (WideTree& wide : refitted) {
            wide.refit(mesh.view());
        }
    }
    const auto questions = questions_about(mesh, 7, count);
    const auto boxes = triangle_boxes(mesh.view());
    const auto expected = ask_in_batches(refitted[0], mesh.view(), questions, Executor::serial());
    const std::span<const Question> few(questions.data(), 5000);
    const auto forced = ask_every_triangle(mesh.view(), few);
    ASSERT_TRUE(std::equal(forced.begin(), forced.end(), expected.begin()));
    const std::vector<std::string> targets = simd_targets();
    for (std::size_t k = 0; k < trees.size(); ++k) {
        Executor executor(kThreads[k % kThreads.size()]);
        const NamedBuilder& named = named_builders()[k];
        const Tree fresh = Tree::build(boxes, {.builder = named.builder}, executor);
        trees[k].refit(boxes, executor);
        optimise_by_reinsertion(
            trees[k], {.max_iterations = 2, .batch_size_ratio = 0.05}, executor);
        const WideTree of_each[] = {
            refitted[k],
            WideTree::build(trees[k], mesh.view(), executor),
            WideTree::build(fresh, mesh.view(), executor),
            WideTree::build(fresh, mesh.view(), executor, LeafEncoding::quantised)};
        for (std::size_t i = 0; i < std::size(of_each); ++i) {
            const std::string& target = targets[(k + i) % targets.size()];
            override_simd_target(target);
            ASSERT_EQ(ask_in_batches(of_each[i], mesh.view(), questions, executor), expected)
                << named.name << ' ' << i << ' ' << target;
        }
        override_simd_target("auto");
    }
}

TEST(SlowIndependence, AMillionRaysOverFourScenesHaveOneAnswerEach) {
    expect_one_answer_to_many(test::triangle_soup(3, 1000), 0.02, 100000);
    expect_one_answer_to_many(test::cube(20, 0.3), 0.0, 300000);
    expect_one_answer_to_many(test::sphere(4, 1.0, Vec3(7000.0, -7000.0, 30.0)), 0.003, 300000);
    expect_one_answer_to_many(test::cube(7, 1e-4), 1e-7, 300000);
}

}  // namespace
}  // namespace earshot::bvh
