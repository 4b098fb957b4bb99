// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/check_object.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/io/scene_glb.h"
#include "earshot/io/whole_file.h"

#include <memory>

namespace earshot::capi {
namespace {

// Those of `earshot check --fix`.
constexpr es_mend_options kDefaults = {
    .struct_size = sizeof(es_mend_options), .max_hole_area = 0.05, .freeze = 0};

es_mend_options checked(const es_mend_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    constexpr double kMaxArea = 1e6;
    const es_mend_options whole =
        require_struct(*options, kDefaults, sizeof(es_mend_options), "options");
    require_in(whole.max_hole_area, 0.0, kMaxArea, "options->max_hole_area");
    require_flag(whole.freeze, "options->freeze");
    return whole;
}

const std::vector<geometry::TriangleId>& list_of(const propagation::MendingReport& report,
                                                 std::int32_t list) {
    require_in(std::int64_t{list}, ES_REMOVED_DEGENERATE, ES_TURNED, "list");
    switch (list) {
        case ES_REMOVED_DEGENERATE:
            return report.degenerate;
        case ES_REMOVED_DOUBLED:
            return report.doubled;
        case ES_REMOVED_UNREACHED:
            return report.unreached;
        case ES_KEPT_UNREACHED:
            return report.doubtful;
        default:
            return report.turned;
    }
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_mend_options_init(es_mend_options* options, size_t size) {
    return call(__func__, [&] { init_struct(kDefaults, options, size, sizeof(es_mend_options)); });
}

es_status es_mending_create(es_model_check check,
                            const es_mend_options* options,
                            es_mending* mending) {
    return call(__func__, [&] {
        const Reading<CheckObject> object(check, "check");
        require(mending, "mending");
        const es_mend_options whole = checked(options);
        *mending = publish(std::make_shared<MendingObject>(
            object->scene,
            propagation::mend_model(object->scene->loaded.scene,
                                    object->report,
                                    {.max_hole_area = whole.max_hole_area,
                                     .time = object->scene->time,
                                     .freeze = whole.freeze == 1})));
    });
}

es_status es_mending_get_info(es_mending mending, es_mending_info* info) {
    return call(__func__, [&] {
        const Reading<MendingObject> object(mending, "mending");
        const propagation::MendingReport& report = object->mended.report;
        es_mending_info values{};
        values.welded_vertices = report.welded_vertices;
        values.filled_holes = report.filled.size();
        for (const propagation::MendingReport::FilledHole& hole : report.filled) {
            values.added_triangles += hole.triangles;
        }
        values.max_rounding = report.max_rounding;
        give_struct(values, info, sizeof(es_mending_info), "info");
    });
}

es_status es_mending_triangles(es_mending mending,
                               int32_t list,
                               const uint32_t** triangles,
                               size_t* count) {
    return call(__func__, [&] {
        const Reading<MendingObject> object(mending, "mending");
        const std::vector<geometry::TriangleId>& values = list_of(object->mended.report, list);
        require(triangles, "triangles");
        require(count, "count") = values.size();
        *triangles = values.data();
    });
}

es_status es_mending_scene(es_mending mending, es_scene* scene) {
    return call(__func__, [&] {
        const Reading<MendingObject> object(mending, "mending");
        require(scene, "scene");
        auto copy = std::make_shared<SceneObject>();
        copy->loaded.scene = object->mended.scene;
        copy->loaded.acoustic_warnings = object->scene->loaded.acoustic_warnings;
        copy->loaded.default_materials = object->scene->loaded.default_materials;
        copy->loaded.materials_by_name = object->scene->loaded.materials_by_name;
        *scene = publish(std::move(copy));
    });
}

es_status es_mending_write(es_mending mending, const char* file) {
    return call(__func__, [&] {
        const Reading<MendingObject> object(mending, "mending");
        const std::string path(require_text(file, "file"));
        if (!path.ends_with(".glb")) {
            fail_argument("file", "does not end in .glb", "name such a file");
        }
        io::write_whole_file(path, io::encode_glb(object->mended.scene));
    });
}
