// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/check_object.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/model_report.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <string_view>

namespace earshot::capi {
namespace {

using propagation::EmitterFault;
using propagation::FaceGroup;
using propagation::MaterialOrigin;
using propagation::ModelPlace;
using propagation::ModelReport;

// Those of `earshot check`, but for the forecast.
constexpr es_check_options kDefaults = {.struct_size = sizeof(es_check_options),
                                        .time = 0.0,
                                        .seed = 1,
                                        .rays = 20'000'000,
                                        .crack = 0.01,
                                        .forecast_seconds = 0.0,
                                        .threads = 0,
                                        .progress = nullptr,
                                        .progress_data = nullptr};

es_check_options checked(const es_check_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    constexpr std::size_t kMinRays = 1000;
    constexpr std::size_t kMaxRays = 1'000'000'000;
    constexpr double kMaxSeconds = 3600.0;
    const es_check_options whole =
        require_struct(*options, kDefaults, sizeof(es_check_options), "options");
    require_time(whole.time, "options->time");
    require_count(whole.rays, kMinRays, kMaxRays, "options->rays");
    require_in(whole.crack, 0.0, 1.0, "options->crack");
    require_in(whole.forecast_seconds, 0.0, kMaxSeconds, "options->forecast_seconds");
    require_threads(whole.threads, "options->threads");
    return whole;
}

void copy(const geometry::Vec3& from, double (&to)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
    }
}

es_place place_of(const geometry::Vec3& centre, const geometry::Vec3& size, double area) {
    es_place place{};
    copy(centre, place.centre);
    copy(size, place.size);
    place.area = area;
    return place;
}

es_place place_of(const ModelPlace& place) {
    return place_of(place.centre, place.size, place.area);
}

std::vector<es_face_group> groups_of(const std::vector<FaceGroup>& groups) {
    std::vector<es_face_group> views;
    for (const FaceGroup& group : groups) {
        views.push_back({.place = place_of(group.place),
                         .triangles = group.triangles,
                         .first_triangle = group.first_triangle,
                         .is_reversed = group.is_reversed ? 1 : 0});
    }
    return views;
}

std::int32_t fault_of(EmitterFault fault) {
    switch (fault) {
        case EmitterFault::in_solid:
            return ES_IN_SOLID;
        case EmitterFault::outside:
            return ES_OUTSIDE;
        case EmitterFault::sealed:
            break;
    }
    return ES_SEALED;
}

std::int32_t origin_of(MaterialOrigin origin) {
    switch (origin) {
        case MaterialOrigin::none:
            return ES_DATA_NONE;
        case MaterialOrigin::by_name:
            return ES_DATA_BY_NAME;
        case MaterialOrigin::library:
            return ES_DATA_LIBRARY;
        case MaterialOrigin::stated:
            break;
    }
    return ES_DATA_STATED;
}

std::int32_t severity_of(propagation::Severity severity) {
    switch (severity) {
        case propagation::Severity::unusable:
            return ES_UNUSABLE;
        case propagation::Severity::questionable:
            return ES_QUESTIONABLE;
        case propagation::Severity::note:
            break;
    }
    return ES_NOTE;
}

/// The name of the unit in which a scene was read.
std::string unit_of(double metres) {
    constexpr std::pair<const char*, double> kUnits[] = {
        {"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"ft", 0.3048}};
    for (const auto& [name, size] : kUnits) {
        if (metres == size) {
            return name;
        }
    }
    return "m";
}

es_check_info info_of(const CheckObject& object) {
    const ModelReport& report = object.report;
    es_check_info info{};
    info.verdict = severity_of(propagation::gravest(object.findings));
    info.outdoors = report.kind == propagation::ModelKind::outdoors ? 1 : 0;
    info.open = report.is_open ? 1 : 0;
    info.findings = object.findings.size();
    info.airs = object.airs.size();
    info.rays = report.rays;
    copy(report.extent.lower, info.lower);
    copy(report.extent.upper, info.upper);
    for (const es_air& air : object.airs) {
        if (air.volume > info.volume) {
            info.volume = air.volume;
            info.surface = air.surface;
        }
    }
    info.unit = object.unit.c_str();
    info.up = object.up.c_str();
    return info;
}

/// Gives an array that belongs to a check.
template <typename T, typename Choose>
es_status give_array(const char* function,
                     es_model_check check,
                     const T** array,
                     size_t* count,
                     const char* argument,
                     Choose&& choose) {
    return call(function, [&] {
        const Reading<CheckObject> object(check, "check");
        const std::vector<T>& values = choose(*object);
        require(array, argument);
        require(count, "count") = values.size();
        *array = values.data();
    });
}

}  // namespace

CheckObject::CheckObject(std::shared_ptr<const CheckedScene> checked, ModelReport model_report)
    : scene(std::move(checked)), report(std::move(model_report)) {
    findings = propagation::model_findings(scene->loaded.scene, report, scene->has_unit_option);
    if (report.unit) {
        unit = report.unit->best.unit;
        up = report.unit->best.up;
    }
    for (const propagation::Leak& leak : report.leaks) {
        leaks.push_back({.place = place_of(leak.place),
                         .escapes = leak.escapes ? 1 : 0,
                         .hole = leak.hole == propagation::Leak::kNoHole
                                     ? ES_NONE
                                     : static_cast<std::uint32_t>(leak.hole)});
    }
    for (const geometry::HoleLoop& hole : report.topology.holes) {
        holes.push_back({.place = place_of(hole.centre, hole.upper - hole.lower, hole.area),
                         .rim_length = hole.rim_length,
                         .edges = static_cast<std::uint32_t>(hole.rim.size()),
                         .is_outline = hole.is_outline ? 1 : 0});
    }
    for (const propagation::MisplacedEmitter& emitter : report.misplaced) {
        es_misplaced view{.item = emitter.is_source ? ES_SOURCES : ES_LISTENERS,
                          .index = static_cast<std::uint32_t>(emitter.index),
                          .position = {},
                          .fault = fault_of(emitter.fault),
                          .proven = emitter.is_proven ? 1 : 0};
        copy(emitter.position, view.position);
        misplaced.push_back(view);
    }
    faces[ES_REVERSED] = groups_of(report.reversed);
    faces[ES_DOUBLED] = groups_of(report.doubled);
    air_of[ES_SOURCES].resize(scene->loaded.scene.sources.size());
    air_of[ES_LISTENERS].resize(scene->loaded.scene.listeners.size());
    for (std::uint32_t i = 0; i < report.airs.size(); ++i) {
        airs.push_back({.volume = report.airs[i].volume, .surface = report.airs[i].surface});
        for (const std::size_t source : report.airs[i].sources) {
            air_of[ES_SOURCES][source] = i;
        }
        for (const std::size_t listener : report.airs[i].listeners) {
            air_of[ES_LISTENERS][listener] = i;
        }
    }
    for (const propagation::MaterialUse& use : report.materials) {
        std::string text;
        for (const std::string& doubt : use.doubts) {
            text += (text.empty() ? "" : ", ") + doubt;
        }
        doubts.push_back(std::move(text));
    }
    for (std::size_t i = 0; i < report.materials.size(); ++i) {
        const propagation::MaterialUse& use = report.materials[i];
        materials.push_back({.origin = origin_of(use.origin),
                             .area = use.area,
                             .absorption_share = use.absorption_share,
                             .doubts = doubts[i].c_str()});
    }
    for (const propagation::SmallFacets& small : report.small_facets) {
        small_facets.push_back({.frequency = small.frequency_hz,
                                .half_wavelength = small.half_wavelength,
                                .facets = small.facets,
                                .area = small.area,
                                .area_share = small.area_share});
    }
    for (const propagation::OrderCost& cost : report.costs) {
        costs.push_back({.order = cost.order,
                         .is_measured = cost.is_measured ? 1 : 0,
                         .seconds = cost.seconds});
    }
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

int32_t es_has_check(void) {
    return geometry::topology_available() ? 1 : 0;
}

es_status es_check_options_init(es_check_options* options, size_t size) {
    return call(__func__, [&] { init_struct(kDefaults, options, size, sizeof(es_check_options)); });
}

es_status es_check_create(es_scene scene, const es_check_options* options, es_model_check* check) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(check, "check");
        const es_check_options whole = checked(options);
        require_triangles_of(object->loaded.scene);
        auto copied = std::make_shared<const CheckedScene>(
            CheckedScene{object->loaded, object->read_as, object->has_unit_option, whole.time});
        Executor executor(whole.threads);
        CallbackProgress progress(whole.progress, whole.progress_data);
        ModelReport report =
            propagation::check_model(copied->loaded.scene,
                                     {.read_as = copied->read_as,
                                      .default_materials = copied->loaded.default_materials,
                                      .materials_by_name = copied->loaded.materials_by_name,
                                      .time = whole.time,
                                      .seed = whole.seed,
                                      .max_rays = whole.rays,
                                      .lambda = whole.crack,
                                      .forecast_seconds = whole.forecast_seconds,
                                      .progress = &progress},
                                     executor);
        *check = publish(std::make_shared<CheckObject>(std::move(copied), std::move(report)));
    });
}

es_status es_check_get_info(es_model_check check, es_check_info* info) {
    return call(__func__, [&] {
        const Reading<CheckObject> object(check, "check");
        give_struct(info_of(*object), info, sizeof(es_check_info), "info");
    });
}

es_status es_check_finding(es_model_check check,
                           size_t index,
                           int32_t* severity,
                           const char** text) {
    return call(__func__, [&] {
        const Reading<CheckObject> object(check, "check");
        require_index(index, object->findings.size(), "index");
        require(severity, "severity");
        require(text, "text") = object->findings[index].text.c_str();
        *severity = severity_of(object->findings[index].severity);
    });
}

es_status es_check_leaks(es_model_check check, const es_leak** leaks, size_t* count) {
    return give_array(
        __func__, check, leaks, count, "leaks", [](const CheckObject& object) -> auto& {
            return object.leaks;
        });
}

es_status es_check_holes(es_model_check check, const es_hole** holes, size_t* count) {
    return give_array(
        __func__, check, holes, count, "holes", [](const CheckObject& object) -> auto& {
            return object.holes;
        });
}

es_status es_check_misplaced(es_model_check check, const es_misplaced** misplaced, size_t* count) {
    return give_array(
        __func__, check, misplaced, count, "misplaced", [](const CheckObject& object) -> auto& {
            return object.misplaced;
        });
}

es_status es_check_faces(es_model_check check,
                         int32_t fault,
                         const es_face_group** groups,
                         size_t* count) {
    return give_array(
        __func__, check, groups, count, "groups", [fault](const CheckObject& object) -> auto& {
            require_in(std::int64_t{fault}, ES_REVERSED, ES_DOUBLED, "fault");
            return object.faces[static_cast<std::size_t>(fault)];
        });
}

es_status es_check_triangles(es_model_check check,
                             int32_t list,
                             const uint32_t** triangles,
                             size_t* count) {
    return give_array(
        __func__, check, triangles, count, "triangles", [list](const CheckObject& object) -> auto& {
            require_in(std::int64_t{list}, ES_UNREACHED, ES_REVERSED_TRIANGLES, "list");
            return list == ES_UNREACHED          ? object.report.unreached
                   : list == ES_PROVEN_UNREACHED ? object.report.proven_unreached
                                                 : object.report.reversed_triangles;
        });
}

es_status es_check_airs(es_model_check check, const es_air** airs, size_t* count) {
    return give_array(
        __func__, check, airs, count, "airs", [](const CheckObject& object) -> auto& {
            return object.airs;
        });
}

es_status es_check_air_of(es_model_check check,
                          int32_t item,
                          const uint32_t** airs,
                          size_t* count) {
    return give_array(
        __func__, check, airs, count, "airs", [item](const CheckObject& object) -> auto& {
            require_in(std::int64_t{item}, ES_SOURCES, ES_LISTENERS, "item");
            return object.air_of[static_cast<std::size_t>(item)];
        });
}

es_status es_check_materials(es_model_check check,
                             const es_material_use** materials,
                             size_t* count) {
    return give_array(
        __func__, check, materials, count, "materials", [](const CheckObject& object) -> auto& {
            return object.materials;
        });
}

es_status es_check_small_facets(es_model_check check,
                                const es_small_facets** octaves,
                                size_t* count) {
    return give_array(
        __func__, check, octaves, count, "octaves", [](const CheckObject& object) -> auto& {
            return object.small_facets;
        });
}

es_status es_check_costs(es_model_check check, const es_order_cost** costs, size_t* count) {
    return give_array(
        __func__, check, costs, count, "costs", [](const CheckObject& object) -> auto& {
            return object.costs;
        });
}

es_status es_check_write(es_model_check check, const char* file) {
    return call(__func__, [&] {
        const Reading<CheckObject> object(check, "check");
        const std::string path(require_text(file, "file"));
        if (!path.ends_with(".json")) {
            fail_argument("file", "does not end in .json", "name such a file");
        }
        io::write_whole_file(
            path,
            io::encode_model_report({.scene = object->scene->loaded.scene,
                                     .report = object->report,
                                     .findings = object->findings,
                                     .unit = unit_of(object->scene->read_as.metres_per_unit)}));
    });
}
