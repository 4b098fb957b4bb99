// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include <gtest/gtest.h>

#include "support/collision_sequences.h"
#include "support/dice.h"
#include "support/moving_meshes.h"
#include <cmath>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using support::Dice;

/// What a step of a mesh against itself finds, and the tests that it takes.
struct Search {
    std::vector<Contact> contacts;
    WorldStatistics statistics;
};

Search search(const MovingMesh& mesh, bool cull_with_normal_cones) {
    World world = world_of({mesh});
    Search result{
        world.contacts({.within_meshes = true, .cull_with_normal_cones = cull_with_normal_cones}),
        {}};
    result.statistics = world.statistics();
    return result;
}

/// Expects the same contacts with and without normal cones; returns how many there are.
std::size_t compare(const MovingMesh& mesh) {
    const Search with = search(mesh, true);
    const Search without = search(mesh, false);
    EXPECT_EQ(with.contacts.size(), without.contacts.size());
    for (std::size_t i = 0; i < std::min(with.contacts.size(), without.contacts.size()); ++i) {
        EXPECT_EQ(found(with.contacts[i]), found(without.contacts[i])) << i;
    }
    EXPECT_LE(with.statistics.elementary_tests, without.statistics.elementary_tests);
    return without.contacts.size();
}

MovingMesh sheet(int columns,
                 int rows,
                 const std::function<Vec3(double, double)>& begin,
                 const std::function<Vec3(double, double)>& end) {
    MovingMesh mesh;
    mesh.triangles = support::grid(columns, rows, false);
    for (int k = 0; k <= rows; ++k) {
        for (int i = 0; i <= columns; ++i) {
            mesh.begin.push_back(begin(i / double(columns), k / double(rows)));
            mesh.end.push_back(end(i / double(columns), k / double(rows)));
        }
    }
    return mesh;
}

TEST(NormalCones, AWavyClothIsNotTestedAgainstItself) {
    const auto wavy = [](double phase) {
        return [phase](double u, double v) {
            return Vec3(u, 0.1 * std::sin(6.0 * u + phase) * std::cos(5.0 * v), v);
        };
    };
    const MovingMesh cloth = sheet(40, 40, wavy(0.0), wavy(0.5));
    const Search result = search(cloth, true);
    EXPECT_TRUE(result.contacts.empty());
    EXPECT_LT(result.statistics.box_tests, 20U);
    EXPECT_EQ(result.statistics.elementary_tests, 0U);
}

TEST(NormalCones, AClothThatCrumplesIsSearchedWhereItDoes) {
    Dice dice(1);
    std::size_t contacts = 0;
    for (const double crumple : {0.01, 0.03, 0.06, 0.2}) {
        const auto crumpled = [&](double u, double v) {
            const double share = u * crumple;
            return Vec3(u + dice.between(-share, share),
                        dice.between(-share, share),
                        v + dice.between(-share, share));
        };
        contacts += compare(sheet(16, 16, crumpled, crumpled));
    }
    EXPECT_GT(contacts, 1000U);
}

TEST(NormalCones, FloorsOfARampAllFaceUpAndYetTouch) {
    // A ramp of two and a half turns, whose floors come down onto each other.
    const auto ramp = [](double pitch) {
        return [pitch](double u, double v) {
            const double turn = 5.0 * 3.14159265358979 * u;
            const double r = 1.0 + v;
            return Vec3(r * std::cos(turn), pitch * u, r * std::sin(turn));
        };
    };
    EXPECT_GT(compare(sheet(60, 3, ramp(1.0), ramp(-1.0))), 100U);
    EXPECT_EQ(compare(sheet(60, 3, ramp(1.0), ramp(0.5))), 0U);
}

TEST(NormalCones, ARollThatTightensTouchesItself) {
    const auto roll = [](double gap) {
        return [gap](double u, double v) {
            const double turn = 4.0 * 3.14159265358979 * u;
            const double r = 0.5 + gap * turn;
            return Vec3(r * std::cos(turn), v, r * std::sin(turn));
        };
    };
    EXPECT_GT(compare(sheet(50, 6, roll(0.05), roll(-0.01))), 10U);
    EXPECT_EQ(compare(sheet(50, 6, roll(0.05), roll(0.03))), 0U);
}

TEST(NormalCones, AContourThatIntersectsItselfFailsTheTest) {
    // A strip bent into a plane loop whose ends overlap: flat, facing up, its ends in one plane.
    const auto bent = [](double height) {
        return [height](double u, double v) {
            const double turn = 2.2 * 3.14159265358979 * u;
            return Vec3((1.0 + v) * std::cos(turn), height * u, (1.0 + v) * std::sin(turn));
        };
    };
    EXPECT_GT(compare(sheet(30, 2, bent(0.1), bent(-0.1))), 5U);
    EXPECT_GT(compare(sheet(30, 2, bent(0.0), bent(0.0))), 5U);
}

TEST(NormalCones, SeamsAndTrianglesThatTurnTheirBacksAreSearched) {
    // Halves that are not sewn together, one of them inside out, and a triangle that stands twice.
    Dice dice(2);
    std::size_t contacts = 0;
    for (int i = 0; i < 20; ++i) {
        const auto flat = [&](double u, double v) { return Vec3(u, dice.between(-0.01, 0.01), v); };
        MovingMesh mesh = sheet(6, 6, flat, flat);
        const MovingMesh other = sheet(6, 6, flat, flat);
        const auto shift = static_cast<geometry::VertexId>(mesh.begin.size());
        for (std::size_t k = 0; k < other.begin.size(); ++k) {
            mesh.begin.push_back(other.begin[k] + Vec3(0.9, 0.0, 0.05 * i));
            mesh.end.push_back(other.end[k] + Vec3(0.9, 0.0, 0.05 * i));
        }
        for (const geometry::Triangle& t : other.triangles) {
            mesh.triangles.push_back({t[1] + shift, t[0] + shift, t[2] + shift});
        }
        mesh.triangles.push_back(mesh.triangles[7]);
        contacts += compare(mesh);
    }
    EXPECT_GT(contacts, 100U);
}

}  // namespace
}  // namespace earshot::collision
