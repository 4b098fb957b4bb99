// SPDX-License-Identifier: MIT
#include "earshot/io/report_contacts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace earshot::io {
namespace {

using Json = nlohmann::json;
using collision::Contact;
using geometry::Vec3;

/// A triangle that moves along x at 1 m/s towards one that rests, over two steps of a second.
struct Fixture {
    std::vector<geometry::Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
    std::vector<std::uint32_t> mesh_of_triangle{0, 1};
    ContactsPage page;

    Fixture() {
        page.title = "door";
        page.contacts.meshes = {"</leaf>", ""};
        page.contacts.steps = {{.t0 = 0.0, .t1 = 1.0}, {.t0 = 1.0, .t1 = 2.0}};
        page.contacts.steps[1].contacts.push_back(
            {.a = {.mesh = 0, .size = 1, .vertices = {2}},
             .b = {.mesh = 1, .size = 3, .vertices = {3, 4, 5}},
             .toi = 0.25,
             .point = {1.25, 0, 0},
             .normal = {1, 0, 0}});
        page.triangles = triangles;
        page.mesh_of_triangle = mesh_of_triangle;
        page.positions_at = [](double time) {
            return std::vector<Vec3>{
                {time, 0, 0}, {time, 1, 0}, {time, 0, 1}, {3, 0, 0}, {3, 1, 0}, {3, 0, 1}};
        };
    }
};

TEST(ContactsReport, ShowsContactsAndMeshesOverTime) {
    const Json data = Json::parse(encode_contacts_page(Fixture().page));
    EXPECT_EQ(data["kind"], "contacts");
    const Json& shown = data["contacts"];
    EXPECT_EQ(shown["times"], Json({0.0, 1.0, 2.0}));
    ASSERT_EQ(shown["meshes"].size(), 2U);
    EXPECT_EQ(shown["meshes"][0]["frames"].size(), 3U);
    EXPECT_EQ(shown["meshes"][0]["frames"][2]["time"], 2.0);
    EXPECT_EQ(shown["meshes"][1]["frames"].size(), 1U);  // it rests
    EXPECT_EQ(shown["meshes"][1]["name"], "mesh 1");
    ASSERT_EQ(shown["contacts"].size(), 1U);
    EXPECT_EQ(shown["contacts"][0]["time"], 1.25);
    EXPECT_EQ(shown["contacts"][0]["kind"], "vertex_face");
    EXPECT_EQ(shown["contacts"][0]["a"], "</leaf>");
    EXPECT_EQ(shown["steps"][0]["count"], 0);
    EXPECT_EQ(shown["summary"][0],
              Json({{"a", "</leaf>"}, {"b", "mesh 1"}, {"count", 1}, {"first", 1.25}}));
    EXPECT_EQ(data["verdict"][0]["answer"],
              "1 contact of 1 pair of meshes; the first at 1.250 (</leaf> and mesh 1)");
}

TEST(ContactsReport, ListsEvenlyChosenContactsOfMany) {
    Fixture fixture;
    auto& contacts = fixture.page.contacts.steps[1].contacts;
    const Contact contact = contacts.front();
    contacts.assign(2 * kMaxReportContacts + 1, contact);
    const Json data = Json::parse(encode_contacts_page(fixture.page));
    const std::size_t listed = data["contacts"]["contacts"].size();
    EXPECT_LE(listed, kMaxReportContacts);
    EXPECT_GE(listed, kMaxReportContacts / 2);
    EXPECT_EQ(data["contacts"]["left_out"], contacts.size() - listed);
    EXPECT_EQ(data["contacts"]["steps"][1]["count"], contacts.size());
    EXPECT_EQ(data["warnings"].size(), 1U);
}

TEST(ContactsReport, ShowsMeshesAtABoundedNumberOfInstants) {
    Fixture fixture;
    fixture.page.contacts.steps.clear();
    for (int i = 0; i < 500; ++i) {
        fixture.page.contacts.steps.push_back({.t0 = 1.0 * i, .t1 = 1.0 * (i + 1)});
    }
    const Json shown = Json::parse(encode_contacts_page(fixture.page))["contacts"];
    const Json& frames = shown["meshes"][0]["frames"];
    ASSERT_EQ(frames.size(), kMaxReportInstants);
    EXPECT_EQ(frames.front()["time"], 0.0);
    EXPECT_EQ(frames.back()["time"], 500.0);
}

TEST(ReadContacts, ReadsWhatIsWritten) {
    const Fixture fixture;
    const std::string text = encode_contacts(fixture.page.contacts);
    const ContactReport read = read_contacts({"contacts.json", text});
    EXPECT_EQ(encode_contacts(read), text);
}

TEST(ReadContacts, RefusesDamagedFiles) {
    const std::string good = encode_contacts(Fixture().page.contacts);
    for (const auto& [from, to] : {std::pair{"vertex_face", "vertex_fade"},
                                   {"\"toi\":0.25", "\"toi\":1.5"},
                                   {"\"toi\":0.25", "\"toi\":null"},
                                   {"\"mesh\":1", "\"mesh\":2"},
                                   {"\"mesh\":1", "\"mesh\":-1"},
                                   {"\"mesh\":1", "\"mesh\":1.5"},
                                   {"\"mesh\":1", "\"mesh\":4294967297"},
                                   {"[3,4,5]", "[3,4,1e300]"},
                                   {"[3,4,5]", "[3,4,-5]"},
                                   {"[3,4,5]", "[3,4,5,6]"},
                                   {"[3,4,5]", "[]"},
                                   {"\"t1\":2.0", "\"t1\":0.0"},
                                   {"\"point\":[", "\"point\":[1,"},
                                   {"\"meshes\"", "\"mashes\""},
                                   {"\"steps\"", "\"stops\""}}) {
        std::string text = good;
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), std::string(from).size(), to);
        EXPECT_THROW(static_cast<void>(read_contacts({"contacts.json", text})), Error) << to;
    }
    for (const char* const text : {"", "{}", "[]", "{\"meshes\":3,\"steps\":[]}"}) {
        EXPECT_THROW(static_cast<void>(read_contacts({"contacts.json", text})), Error) << text;
    }
}

}  // namespace
}  // namespace earshot::io
