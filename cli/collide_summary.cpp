// SPDX-License-Identifier: MIT
#include "earshot/cli/collide_summary.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/cli/update_summary.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;
using collision::Contact;

/// What is known of a pair of meshes over all steps.
struct PairSummary {
    std::size_t contacts = 0;
    std::optional<double> first_time{};    // seconds, or numbers of poses
    std::optional<double> min_distance{};  // metres
    std::optional<double> max_depth{};
};

/// A contact with the time at which it is.
struct TimedContact {
    double time = 0.0;
    Contact contact;
};

double time_of(const io::ContactStep& step, const Contact& contact) {
    return step.t0 + contact.toi * (step.t1 - step.t0);
}

std::map<std::pair<std::uint32_t, std::uint32_t>, PairSummary> pairs_of(
    const io::ContactReport& report) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, PairSummary> pairs;
    for (const io::ContactStep& step : report.steps) {
        for (const Contact& contact : step.contacts) {
            PairSummary& pair = pairs[std::minmax(contact.a.mesh, contact.b.mesh)];
            ++pair.contacts;
            const double time = time_of(step, contact);
            pair.first_time = std::min(pair.first_time.value_or(time), time);
        }
        if (!step.distances) {
            continue;
        }
        for (const io::PairDistance& each : *step.distances) {
            PairSummary& pair = pairs[{each.a, each.b}];
            if (each.distance) {
                pair.min_distance = std::min(pair.min_distance.value_or(each.distance->distance),
                                             each.distance->distance);
            }
            if (each.depth) {
                pair.max_depth =
                    std::max(pair.max_depth.value_or(each.depth->depth), each.depth->depth);
            }
        }
    }
    return pairs;
}

std::optional<TimedContact> first_of(const io::ContactReport& report) {
    for (const io::ContactStep& step : report.steps) {
        if (!step.contacts.empty()) {
            return TimedContact{time_of(step, step.contacts.front()), step.contacts.front()};
        }
    }
    return std::nullopt;
}

std::string name_of(const io::ContactReport& report, std::uint32_t mesh) {
    const std::string& name = report.meshes[mesh];
    return name.empty() ? "mesh " + std::to_string(mesh) : on_one_line(name);
}

std::string digits(double value) {
    return formatted("%.9g", value);
}

std::string element_text(const io::ContactReport& report, const collision::Element& element) {
    constexpr std::array<const char*, 4> kKinds{"", "vertex", "edge", "face"};
    std::string text = name_of(report, element.mesh) + " " + kKinds[element.size];
    for (std::uint32_t i = 0; i < element.size; ++i) {
        text += " " + std::to_string(element.vertices[i]);
    }
    return text;
}

std::string pair_text(const io::ContactReport& report,
                      const std::pair<std::uint32_t, std::uint32_t>& meshes,
                      const PairSummary& pair) {
    std::string text = "pair       " + name_of(report, meshes.first) + " - " +
                       name_of(report, meshes.second) + ": " + std::to_string(pair.contacts) +
                       (pair.contacts == 1 ? " contact" : " contacts");
    if (pair.first_time) {
        text += ", first at " + digits(*pair.first_time);
    }
    if (pair.min_distance) {
        text += ", distance " + digits(*pair.min_distance) + " m";
    }
    if (pair.max_depth) {
        text += ", depth " + digits(*pair.max_depth) + " m";
    }
    return text + "\n";
}

Json pair_json(const std::pair<std::uint32_t, std::uint32_t>& meshes, const PairSummary& pair) {
    Json json = {{"a", meshes.first}, {"b", meshes.second}, {"contacts", pair.contacts}};
    for (const auto& [key, value] : {std::pair("first", pair.first_time),
                                     {"distance", pair.min_distance},
                                     {"depth", pair.max_depth}}) {
        if (value) {
            json[key] = *value;
        }
    }
    return json;
}

}  // namespace

std::string collide_summary(const CollideMotion& motion,
                            const io::ContactReport& report,
                            const CollideTotals& totals,
                            const CollideSummaryOptions& options,
                            const std::string& file) {
    const std::string time = formatted(
        "time       %.3f s, %.1f ms a step\n",
        totals.seconds,
        totals.steps > 0 ? 1e3 * totals.seconds / static_cast<double>(totals.steps) : 0.0);
    std::string text = "meshes     " + std::to_string(report.meshes.size()) + ", " +
                       std::to_string(motion.triangles) + " triangles\nsteps      " +
                       std::to_string(totals.steps) + "\ncontacts   " +
                       std::to_string(totals.contacts) + "\n";
    if (options.first) {
        const auto first = first_of(report);
        text +=
            "first      " +
            (first ? "at " + digits(first->time) + ": " + element_text(report, first->contact.a) +
                         " and " + element_text(report, first->contact.b)
                   : std::string("none")) +
            "\n";
    }
    if (options.pairs) {
        for (const auto& [meshes, pair] : pairs_of(report)) {
            text += pair_text(report, meshes, pair);
        }
    }
    return text + "tests      " + std::to_string(totals.statistics.box_tests) + " of boxes, " +
           std::to_string(totals.statistics.triangle_pairs) + " pairs of triangles, " +
           std::to_string(totals.statistics.elementary_tests) + " of elements\ntrees      " +
           update_text(totals.statistics.updates) + "\n" + time.data() + "file       " + file +
           "\n";
}

std::string collide_summary_json(const CollideMotion& motion,
                                 const io::ContactReport& report,
                                 const CollideTotals& totals,
                                 const CollideSummaryOptions& options,
                                 const std::string& file) {
    Json json = {{"version", 1},
                 {"meshes", report.meshes.size()},
                 {"triangles", motion.triangles},
                 {"steps", totals.steps},
                 {"contacts", totals.contacts},
                 {"box_tests", totals.statistics.box_tests},
                 {"triangle_pairs", totals.statistics.triangle_pairs},
                 {"elementary_tests", totals.statistics.elementary_tests},
                 {"front_nodes", totals.statistics.front_nodes},
                 {"hierarchy", update_json(totals.statistics.updates)},
                 {"seconds", totals.seconds},
                 {"file", file}};
    if (options.first) {
        const auto first = first_of(report);
        json["first"] = first ? Json(first->time) : Json(nullptr);
    }
    if (options.pairs) {
        json["pairs"] = Json::array();
        for (const auto& [meshes, pair] : pairs_of(report)) {
            json["pairs"].push_back(pair_json(meshes, pair));
        }
    }
    return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace earshot::cli
