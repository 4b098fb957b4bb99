// SPDX-License-Identifier: MIT
#include "earshot/io/contacts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace earshot::io {
namespace {

using collision::Contact;
using collision::ContactKind;
using Json = nlohmann::ordered_json;

Contact contact(std::uint32_t number) {
    const double x = 0.1 * number;
    return {.kind = number % 2 == 0 ? ContactKind::vertex_face : ContactKind::edge_edge,
            .a = {.mesh = 0, .size = number % 2 == 0 ? 1U : 2U, .vertices = {number, number + 1}},
            .b = {.mesh = 1,
                  .size = number % 2 == 0 ? 3U : 2U,
                  .vertices = {4, 4294967295U, number + 5}},
            .toi = 1.0 / (number + 1.0),
            .point = {x, -0.0, 1e-300 * number},
            .normal = {0.0, 1.0, 1e22}};
}

/// A contact as nlohmann-json writes it, which the library does not.
std::string expected_line(const Contact& c) {
    const auto element = [](const collision::Element& e) {
        Json vertices = Json::array();
        for (std::uint32_t i = 0; i < e.size; ++i) {
            vertices.push_back(e.vertices[i]);
        }
        return Json({{"mesh", e.mesh}, {"element", vertices}});
    };
    const auto vector = [](const geometry::Vec3& v) { return Json::array({v.x, v.y, v.z}); };
    return Json({{"kind", name_of(c.kind)},
                 {"a", element(c.a)},
                 {"b", element(c.b)},
                 {"toi", c.toi},
                 {"point", vector(c.point)},
                 {"normal", vector(c.normal)}})
        .dump();
}

TEST(Contacts, StandOnALineEachAsTheJsonLibraryWouldWriteThem) {
    ContactReport report{.meshes = {"a \"b\"", ""}};
    std::string expected = "{\"version\":1,\"meshes\":[\"a \\\"b\\\"\",\"\"],\"steps\":[";
    // More than are encoded at a time, fewer, and none.
    for (const std::uint32_t count : {70000U, 3U, 0U}) {
        ContactStep& step = report.steps.emplace_back();
        step.t0 = static_cast<double>(report.steps.size());
        step.t1 = step.t0 + 0.5;
        expected += (report.steps.size() == 1 ? "\n {\"t0\":" : ",\n {\"t0\":") +
                    Json(step.t0).dump() + ",\"t1\":" + Json(step.t1).dump() + ",\"contacts\":[";
        for (std::uint32_t i = 0; i < count; ++i) {
            step.contacts.push_back(contact(i));
            expected += (i == 0 ? "\n  " : ",\n  ") + expected_line(step.contacts.back());
        }
        expected += "]}";
    }
    expected += "]}\n";
    const std::string text = encode_contacts(report);
    ASSERT_EQ(text.size(), expected.size());
    EXPECT_TRUE(text == expected);
    Executor executor(3);
    std::string parallel;
    write_contacts(
        report, [&](std::string_view piece) { parallel += piece; }, executor);
    EXPECT_TRUE(parallel == expected);
}

TEST(Contacts, DistancesHoldWhatIsKnown) {
    ContactReport report{.meshes = {"a", "b", "c"}};
    ContactStep& step = report.steps.emplace_back();
    step.distances.emplace();
    step.distances->push_back(
        {.a = 0,
         .b = 1,
         .distance = collision::MeshDistance{
             .distance = 0.5, .triangles = {7, 8}, .on_a = {1, 2, 3}, .on_b = {1, 2, 3.5}}});
    step.distances->push_back(
        {.a = 0,
         .b = 2,
         .distance = collision::MeshDistance{.distance = 0.0},
         .depth = collision::SolidDepth{.depth = 0.25, .move = {0, 0.25, 0}, .part_b = 3}});
    step.distances->push_back({.a = 1, .b = 2, .distance = collision::MeshDistance{}});
    const Json distances = Json::parse(encode_contacts(report))["steps"][0]["distances"];
    EXPECT_EQ(distances[0],
              Json({{"a", 0},
                    {"b", 1},
                    {"distance", 0.5},
                    {"triangles", {7, 8}},
                    {"points", {{1.0, 2.0, 3.0}, {1.0, 2.0, 3.5}}}}));
    EXPECT_EQ(distances[1],
              Json({{"a", 0},
                    {"b", 2},
                    {"distance", 0.0},
                    {"depth", 0.25},
                    {"move", {0.0, 0.25, 0.0}},
                    {"parts", {0, 3}}}));
    // A mesh without triangles is infinitely far away, which JSON cannot say.
    EXPECT_EQ(distances[2], Json({{"a", 1}, {"b", 2}, {"distance", nullptr}}));
}

}  // namespace
}  // namespace earshot::io
