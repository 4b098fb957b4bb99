// SPDX-License-Identifier: MIT
#include "earshot/propagation/pair_notes.h"

#include <gtest/gtest.h>

namespace earshot::propagation {
namespace {

PairResult heard_pair() {
    PairResult pair;
    pair.paths.push_back({.kind = PathKind::direct});
    return pair;
}

TEST(PairNotes, TellOfPairsWithoutADirectPath) {
    Scene scene;
    scene.name = "hall";
    scene.sources = {{.name = "stage"}};
    scene.listeners = {{.name = "seat"}, {.name = "box"}, {.name = "foyer"}};
    std::vector<PairResult> pairs(3, heard_pair());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].listener = i;
    }
    EXPECT_TRUE(note_blocked_pairs(scene, pairs).empty());
    pairs[1].paths.front().kind = PathKind::specular;
    ASSERT_EQ(note_blocked_pairs(scene, pairs).size(), 1U);
    EXPECT_EQ(note_blocked_pairs(scene, pairs).front().subject, "stage to box");
    pairs[2].paths.clear();
    ASSERT_EQ(note_blocked_pairs(scene, pairs).size(), 1U);
    EXPECT_EQ(note_blocked_pairs(scene, pairs).front().subject, "hall");
    EXPECT_NE(note_blocked_pairs(scene, pairs).front().what.find("2 of 3 pairs"),
              std::string::npos);
}

TEST(PairNotes, TellOfSilenceAndOfTooFewRays) {
    EXPECT_TRUE(note_sound(heard_pair(), "a to b").empty());
    PairResult arrivals_alone;
    arrivals_alone.arrivals.emplace_back();
    EXPECT_TRUE(note_sound(arrivals_alone, "a to b").empty());
    PairResult silent;
    silent.late_errors = {.rays = 5000, .t30 = 0.013, .level_db = 0.5, .reached = false};
    const Warnings notes = note_sound(silent, "a to b");
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_EQ(notes[0].subject, "a to b");
    EXPECT_EQ(notes[0].what, "no path up to the given order: the response is silent");
    EXPECT_EQ(notes[1].subject, "a to b");
    EXPECT_EQ(notes[1].what,
              "after 5000 rays the standard error of T30 is 1.3 %, that of the level 0.50 dB");
}

}  // namespace
}  // namespace earshot::propagation
