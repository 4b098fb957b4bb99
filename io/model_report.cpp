// SPDX-License-Identifier: MIT
#include "earshot/io/model_report.h"

#include "earshot/io/internal/json_lines.h"

#include <algorithm>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using geometry::Vec3;
using namespace propagation;

Json vector_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Json place_of(const ModelPlace& place) {
    return {
        {"centre", vector_of(place.centre)}, {"size", vector_of(place.size)}, {"area", place.area}};
}

Json units_of(const ModelReportParts& parts) {
    Json units = {{"taken", parts.unit},
                  {"proposed", nullptr},
                  {"up", nullptr},
                  {"reason", ""},
                  {"others", Json::array()}};
    if (const auto& proposal = parts.report.unit) {
        if (!proposal->best.unit.empty()) {
            units["proposed"] = std::string(proposal->best.unit);
        }
        if (!proposal->best.up.empty()) {
            units["up"] = std::string(proposal->best.up);
        }
        units["reason"] = unit_reason(*proposal);
        for (const UnitReading& other : proposal->others) {
            units["others"].push_back(std::string(other.unit));
        }
    }
    return units;
}

Json emitters_with(const ModelReportParts& parts, EmitterFault fault) {
    Json list = Json::array();
    for (const MisplacedEmitter& misplaced : parts.report.misplaced) {
        if (misplaced.fault == fault) {
            const Emitter& emitter = misplaced.is_source ? parts.scene.sources[misplaced.index]
                                                         : parts.scene.listeners[misplaced.index];
            list.push_back({{"kind", misplaced.is_source ? "source" : "listener"},
                            {"name", emitter.name},
                            {"position", vector_of(misplaced.position)},
                            {"proven", misplaced.is_proven}});
        }
    }
    return list;
}

Json airs_of(const ModelReportParts& parts) {
    Json list = Json::array();
    for (const SharedAir& air : parts.report.airs) {
        Json sources = Json::array();
        Json listeners = Json::array();
        for (const std::size_t i : air.sources) {
            sources.push_back(parts.scene.sources[i].name);
        }
        for (const std::size_t i : air.listeners) {
            listeners.push_back(parts.scene.listeners[i].name);
        }
        Json json = {{"sources", sources}, {"listeners", listeners}};
        json["volume"] = air.volume > 0.0 ? Json(air.volume) : Json(nullptr);
        json["surface"] = air.volume > 0.0 ? Json(air.surface) : Json(nullptr);
        list.push_back(json);
    }
    return list;
}

Json faces_of(const std::vector<FaceGroup>& groups, bool with_sense) {
    Json list = Json::array();
    for (const FaceGroup& group : groups) {
        Json json = place_of(group.place);
        json["triangles"] = group.triangles;
        json["first_triangle"] = group.first_triangle;
        if (with_sense) {
            json["reversed"] = group.is_reversed;
        }
        list.push_back(json);
    }
    return list;
}

Json leaks_of(const ModelReport& report) {
    Json list = Json::array();
    for (const Leak& leak : report.leaks) {
        Json json = place_of(leak.place);
        json["to"] = leak.escapes ? "outside" : "solid";
        json["hole"] = leak.hole == Leak::kNoHole ? Json(nullptr) : Json(leak.hole);
        list.push_back(json);
    }
    return list;
}

Json holes_of(const ModelReport& report) {
    Json list = Json::array();
    for (const geometry::HoleLoop& hole : report.topology.holes) {
        list.push_back({{"centre", vector_of(hole.centre)},
                        {"size", vector_of(hole.upper - hole.lower)},
                        {"area", hole.area},
                        {"rim_length", hole.rim_length},
                        {"edges", hole.rim.size()},
                        {"outline", hole.is_outline}});
    }
    return list;
}

Json topology_of(const geometry::MeshTopology& topology) {
    Json t_junctions = Json::array();
    for (const geometry::TJunction& junction : topology.t_junctions) {
        t_junctions.push_back(vector_of(junction.position));
    }
    Json slivers = Json::array();
    for (const geometry::Sliver& sliver : topology.slivers) {
        slivers.push_back({{"triangle", sliver.triangle},
                           {"centre", vector_of(sliver.centre)},
                           {"height", sliver.height},
                           {"length", sliver.length}});
    }
    const auto closed = std::count_if(topology.islands.begin(),
                                      topology.islands.end(),
                                      [](const auto& island) { return island.is_closed; });
    return {{"islands", topology.islands.size()},
            {"closed_islands", closed},
            {"flipped_triangles", topology.flipped.size()},
            {"degenerate_triangles", topology.clean.report.degenerate_triangles},
            {"non_manifold_edges", topology.clean.report.non_manifold_edges},
            {"open_edges", topology.clean.report.open_edges},
            {"t_junctions", t_junctions},
            {"slivers", slivers}};
}

const char* word_of(MaterialOrigin origin) {
    switch (origin) {
        case MaterialOrigin::none:
            return "default";
        case MaterialOrigin::by_name:
            return "by_name";
        case MaterialOrigin::library:
            return "library";
        case MaterialOrigin::stated:
            break;
    }
    return "given";
}

Json materials_of(const ModelReportParts& parts) {
    Json list = Json::array();
    for (std::size_t i = 0; i < parts.report.materials.size(); ++i) {
        const MaterialUse& use = parts.report.materials[i];
        list.push_back({{"name", parts.scene.materials[i].name},
                        {"data", word_of(use.origin)},
                        {"area", use.area},
                        {"absorption_share", use.absorption_share},
                        {"doubts", use.doubts}});
    }
    return list;
}

/// Ascending numbers as runs, first and last.
Json runs_of(const std::vector<geometry::TriangleId>& ascending) {
    Json list = Json::array();
    for (std::size_t i = 0; i < ascending.size();) {
        std::size_t last = i;
        while (last + 1 < ascending.size() && ascending[last + 1] == ascending[last] + 1) {
            ++last;
        }
        list.push_back({ascending[i], ascending[last]});
        i = last + 1;
    }
    return list;
}

Json small_facets_of(const ModelReport& report) {
    Json list = Json::array();
    for (const SmallFacets& small : report.small_facets) {
        list.push_back({{"frequency_hz", small.frequency_hz},
                        {"half_wavelength", small.half_wavelength},
                        {"facets", small.facets},
                        {"area", small.area},
                        {"area_share", small.area_share}});
    }
    return list;
}

Json findings_of(std::span<const Finding> findings) {
    Json list = Json::array();
    for (const Finding& finding : findings) {
        list.push_back({{"severity",
                         finding.severity == Severity::unusable       ? "unusable"
                         : finding.severity == Severity::questionable ? "questionable"
                                                                      : "note"},
                        {"text", finding.text}});
    }
    return list;
}

Json mending_of(const MendingReport& mending) {
    Json filled = Json::array();
    for (const MendingReport::FilledHole& hole : mending.filled) {
        filled.push_back({{"hole", hole.hole}, {"triangles", hole.triangles}});
    }
    return {{"welded_vertices", mending.welded_vertices},
            {"removed_degenerate", mending.degenerate},
            {"removed_doubled", mending.doubled},
            {"removed_unreached", mending.unreached},
            {"kept_unreached", mending.doubtful},
            {"turned", mending.turned},
            {"filled_holes", filled},
            {"max_rounding", mending.max_rounding}};
}

}  // namespace

std::string encode_model_report(const ModelReportParts& parts) {
    const ModelReport& report = parts.report;
    const SharedAir* largest = nullptr;
    for (const SharedAir& air : report.airs) {
        largest = largest == nullptr || air.volume > largest->volume ? &air : largest;
    }
    const Severity severity = gravest(parts.findings);
    Json head = {{"version", 1},
                 {"scene", parts.scene.name},
                 {"verdict",
                  severity == Severity::unusable       ? "unusable"
                  : severity == Severity::questionable ? "questionable"
                                                       : "clean"},
                 {"extent", vector_of(report.extent.size())},
                 {"units", units_of(parts)},
                 {"volume", nullptr},
                 {"surface", nullptr},
                 {"open", report.is_open},
                 {"rays", report.rays},
                 {"unreached_triangles", report.unreached.size()},
                 {"proven_unreached_triangles", report.proven_unreached.size()},
                 {"unreached", runs_of(report.unreached)},
                 {"proven_unreached", runs_of(report.proven_unreached)},
                 {"topology", topology_of(report.topology)}};
    if (largest != nullptr && largest->volume > 0.0) {
        head["volume"] = largest->volume;
        head["surface"] = largest->surface;
    }
    if (report.probe) {
        head["probe"] = vector_of(*report.probe);
    }
    Json seconds = Json::object();
    for (const OrderCost& cost : report.costs) {
        seconds[std::to_string(cost.order)] = cost.seconds;
    }
    head["seconds"] = seconds;
    if (parts.mending != nullptr) {
        head["mending"] = mending_of(*parts.mending);
    }
    JsonLines lines;
    std::string text = json_text(head);
    text.pop_back();
    lines.append(text);
    lines.add_list("findings", findings_of(parts.findings));
    lines.add_list("airs", airs_of(parts));
    lines.add_list("leaks", leaks_of(report));
    lines.add_list("holes", holes_of(report));
    lines.add_list("in_solid", emitters_with(parts, EmitterFault::in_solid));
    lines.add_list("outside", emitters_with(parts, EmitterFault::outside));
    lines.add_list("sealed", emitters_with(parts, EmitterFault::sealed));
    lines.add_list("reversed", faces_of(report.reversed, false));
    lines.add_list("doubled", faces_of(report.doubled, true));
    lines.add_list("materials", materials_of(parts));
    lines.add_list("small_facets", small_facets_of(report));
    return lines.finish();
}

}  // namespace earshot::io
