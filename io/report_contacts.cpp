// SPDX-License-Identifier: MIT
#include "earshot/io/report_contacts.h"

#include "earshot/io/internal/base64.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using collision::Contact;

double time_of(const ContactStep& step, const Contact& contact) {
    return step.t0 + contact.toi * (step.t1 - step.t0);
}

std::string name_of(const ContactReport& report, std::uint32_t mesh) {
    const std::string& name = report.meshes[mesh];
    return name.empty() ? "mesh " + std::to_string(mesh) : name;
}

/// Evenly spaced ones of so many, the first and the last among them.
std::vector<std::size_t> evenly(std::size_t count, std::size_t max_count) {
    const std::size_t kept = std::min(count, std::max<std::size_t>(max_count, 1));
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < kept; ++i) {
        chosen.push_back(kept == 1 ? 0 : i * (count - 1) / (kept - 1));
    }
    return chosen;
}

/// Beginnings of the steps and the end of the last.
std::vector<double> instants_of(const ContactReport& report) {
    std::vector<double> times;
    for (const ContactStep& step : report.steps) {
        times.push_back(step.t0);
    }
    if (!times.empty() && report.steps.back().t1 > times.back()) {
        times.push_back(report.steps.back().t1);
    }
    return times;
}

/// One mesh of a page: its triangles, by the numbers of its own vertices.
struct ShownMesh {
    std::vector<geometry::VertexId> vertices;  ///< of the page's scene
    std::vector<std::uint32_t> corners;
    std::vector<std::pair<double, std::string>> frames;  ///< positions as base64
};

std::vector<ShownMesh> meshes_of(const ContactsPage& page, std::size_t triangles) {
    std::vector<ShownMesh> meshes(page.contacts.meshes.size());
    std::vector<std::map<geometry::VertexId, std::uint32_t>> number(meshes.size());
    for (std::size_t triangle = 0; triangle < triangles; ++triangle) {
        const std::uint32_t mesh = page.mesh_of_triangle[triangle];
        for (const geometry::VertexId vertex : page.triangles[triangle]) {
            const auto [known, is_new] = number[mesh].try_emplace(
                vertex, static_cast<std::uint32_t>(meshes[mesh].vertices.size()));
            if (is_new) {
                meshes[mesh].vertices.push_back(vertex);
            }
            meshes[mesh].corners.push_back(known->second);
        }
    }
    return meshes;
}

/// A mesh that rests has one frame.
void add_frames(const ContactsPage& page,
                std::span<const double> times,
                std::vector<ShownMesh>& meshes) {
    for (const double time : times) {
        const std::vector<geometry::Vec3> positions = page.positions_at(time);
        for (ShownMesh& mesh : meshes) {
            std::vector<float> coordinates;
            for (const geometry::VertexId vertex : mesh.vertices) {
                for (int axis = 0; axis < 3; ++axis) {
                    coordinates.push_back(static_cast<float>(positions[vertex][axis]));
                }
            }
            mesh.frames.emplace_back(time, base64(coordinates));
        }
    }
    for (ShownMesh& mesh : meshes) {
        const bool rests =
            std::all_of(mesh.frames.begin(), mesh.frames.end(), [&](const auto& frame) {
                return frame.second == mesh.frames.front().second;
            });
        if (rests && !mesh.frames.empty()) {
            mesh.frames.resize(1);
        }
    }
}

Json meshes_block(const ContactsPage& page, std::span<const double> times, Warnings& warnings) {
    const std::size_t shown = std::min(page.triangles.size(), kMaxReportTriangles);
    if (shown < page.triangles.size()) {
        warnings.push_back({page.title,
                            "the page shows the first " + std::to_string(shown) + " of " +
                                std::to_string(page.triangles.size()) + " triangles"});
    }
    std::vector<ShownMesh> meshes = meshes_of(page, shown);
    std::size_t vertices = 0;
    for (const ShownMesh& mesh : meshes) {
        vertices += mesh.vertices.size();
    }
    const std::size_t max_instants =
        std::min(kMaxReportInstants, kMaxReportPositions / std::max<std::size_t>(vertices, 1));
    std::vector<double> shown_times;
    for (const std::size_t instant : evenly(times.size(), max_instants)) {
        shown_times.push_back(times[instant]);
    }
    if (shown_times.size() < times.size()) {
        warnings.push_back({page.title,
                            "the page shows the meshes at " + std::to_string(shown_times.size()) +
                                " of " + std::to_string(times.size()) + " instants"});
    }
    add_frames(page, shown_times, meshes);
    Json list = Json::array();
    for (std::uint32_t i = 0; i < meshes.size(); ++i) {
        Json frames = Json::array();
        for (const auto& [time, positions] : meshes[i].frames) {
            frames.push_back({{"time", time}, {"positions_f32", positions}});
        }
        list.push_back({{"name", name_of(page.contacts, i)},
                        {"triangles_u32", base64(meshes[i].corners)},
                        {"frames", std::move(frames)}});
    }
    return list;
}

Json contact_json(const ContactReport& report, const ContactStep& step, const Contact& contact) {
    const auto list = [](const geometry::Vec3& v) { return Json::array({v.x, v.y, v.z}); };
    return {{"time", time_of(step, contact)},
            {"kind", collision::name_of(contact.kind)},
            {"a", name_of(report, contact.a.mesh)},
            {"b", name_of(report, contact.b.mesh)},
            {"point", list(contact.point)},
            {"normal", list(contact.normal)}};
}

/// Contacts of a pair of meshes over all steps.
struct PairOfMeshes {
    std::size_t count = 0;
    double first = 0.0;  // seconds, or the number of a pose
};

/// What the steps of a report hold.
struct ContactLists {
    Json contacts = Json::array();
    Json steps = Json::array();
    std::map<std::pair<std::uint32_t, std::uint32_t>, PairOfMeshes> pairs{};
    std::size_t count = 0;
    std::size_t left_out = 0;
};

ContactLists lists_of(const ContactReport& report) {
    ContactLists lists;
    std::size_t all = 0;
    for (const ContactStep& step : report.steps) {
        all += step.contacts.size();
    }
    const std::size_t stride =
        std::max<std::size_t>(1, (all + kMaxReportContacts - 1) / kMaxReportContacts);
    for (const ContactStep& step : report.steps) {
        if (lists.steps.size() < kMaxReportContactSteps) {
            lists.steps.push_back(
                {{"t0", step.t0}, {"t1", step.t1}, {"count", step.contacts.size()}});
        }
        for (const Contact& contact : step.contacts) {
            if (lists.count++ % stride == 0) {
                lists.contacts.push_back(contact_json(report, step, contact));
            }
            const auto [pair, is_new] =
                lists.pairs.try_emplace(std::minmax(contact.a.mesh, contact.b.mesh),
                                        PairOfMeshes{.first = time_of(step, contact)});
            ++pair->second.count;
            pair->second.first = std::min(pair->second.first, time_of(step, contact));
        }
    }
    lists.left_out = all - lists.contacts.size();
    return lists;
}

Json summary_block(const ContactReport& report, const ContactLists& lists) {
    Json summary = Json::array();
    for (const auto& [meshes, pair] : lists.pairs) {
        summary.push_back({{"a", name_of(report, meshes.first)},
                           {"b", name_of(report, meshes.second)},
                           {"count", pair.count},
                           {"first", pair.first}});
    }
    return summary;
}

/// "1 contact", "2 contacts".
std::string counted(std::size_t count, const std::string& thing) {
    return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

Json verdict_of(const ContactReport& report, const ContactLists& lists) {
    std::string answer = "no contact in " + counted(report.steps.size(), "step");
    if (lists.count > 0) {
        const auto& [meshes, pair] = *std::min_element(
            lists.pairs.begin(), lists.pairs.end(), [](const auto& a, const auto& b) {
                return a.second.first < b.second.first;
            });
        std::array<char, 64> time{};
        std::snprintf(time.data(), time.size(), "%.3f", pair.first);
        answer = counted(lists.count, "contact") + " of " + counted(lists.pairs.size(), "pair") +
                 " of meshes; the first at " + time.data() + " (" +
                 (meshes.first == meshes.second
                      ? "within " + name_of(report, meshes.first)
                      : name_of(report, meshes.first) + " and " + name_of(report, meshes.second)) +
                 ")";
    }
    return Json::array(
        {Json{{"question", "What touches?"}, {"answer", answer}, {"state", "told"}}});
}

}  // namespace

std::string encode_contacts_page(const ContactsPage& page) {
    const ContactReport& report = page.contacts;
    Warnings warnings = page.warnings;
    const std::vector<double> times = instants_of(report);
    const ContactLists lists = lists_of(report);
    if (lists.left_out > 0) {
        warnings.push_back({page.title,
                            "the page lists " + std::to_string(lists.contacts.size()) + " of " +
                                std::to_string(lists.count) + " contacts, evenly chosen"});
    }
    Json contacts = {{"times", times}};
    if (!page.triangles.empty()) {
        contacts["meshes"] = meshes_block(page, times, warnings);
    }
    contacts["contacts"] = lists.contacts;
    contacts["left_out"] = lists.left_out;
    contacts["steps"] = lists.steps;
    contacts["summary"] = summary_block(report, lists);
    const Json data = {{"format", 1},
                       {"kind", "contacts"},
                       {"title", page.title},
                       {"provenance", provenance_block(page.provenance, "")},
                       {"verdict", verdict_of(report, lists)},
                       {"warnings", warnings_block(warnings)},
                       {"contacts", std::move(contacts)}};
    return json_text(data) + "\n";
}

}  // namespace earshot::io
