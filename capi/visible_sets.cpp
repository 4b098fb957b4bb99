// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/visible_sets_object.h"
#include "earshot/io/visibility_file.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

namespace earshot::capi {
namespace {

template <typename T>
void copy_vector(const geometry::Vec3& from, T& to) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
    }
}

es_visible_sets_info info_of(const visibility::VisibleSets& sets) {
    es_visible_sets_info info{};
    info.cells = sets.cells().size();
    info.objects = sets.objects().size();
    info.triangles = sets.objects().object_of_triangle().size();
    info.entries = sets.entries();
    copy_vector(sets.cells().region().lower, info.lower);
    copy_vector(sets.cells().region().upper, info.upper);
    info.scene = sets.provenance().scene.c_str();
    info.time = sets.provenance().time;
    info.mesh_digest = sets.provenance().mesh_digest;
    info.rays = sets.provenance().rays;
    info.seed = sets.provenance().seed;
    const auto& validation = sets.provenance().validation;
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    info.validation_rays = validation ? validation->rays : 0;
    info.missed_share = validation ? validation->estimate() : kUnknown;
    info.missed_share_upper = validation ? validation->upper_bound() : kUnknown;
    return info;
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_visible_sets_read(const char* file, es_visible_sets* sets) {
    return call(__func__, [&] {
        const std::string path(require_text(file, "file"));
        require(sets, "sets");
        *sets = publish(std::make_shared<VisibleSetsObject>(io::read_visible_sets(path)));
    });
}

es_status es_visible_sets_write(es_visible_sets sets, const char* file) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        io::write_visible_sets(std::string(require_text(file, "file")), object->sets);
    });
}

es_status es_visible_sets_get_info(es_visible_sets sets, es_visible_sets_info* info) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        give_struct(info_of(object->sets), info, sizeof(es_visible_sets_info), "info");
    });
}

es_status es_visible_sets_locate(es_visible_sets sets,
                                 const double* points,
                                 size_t count,
                                 uint32_t* cells) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        const auto at = require_points(points, count, "points");
        const auto out = require_array(cells, count, "cells");
        std::transform(at.begin(), at.end(), out.begin(), [&](const geometry::Vec3& point) {
            return object->sets.cells().cell_at(point).value_or(ES_NONE);
        });
    });
}

es_status es_visible_sets_volumes(es_visible_sets sets, const double** volumes, size_t* count) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        require(volumes, "volumes");
        require(count, "count") = object->sets.cells().size();
        *volumes = object->sets.cells().volumes().data();
    });
}

es_status es_visible_sets_objects(es_visible_sets sets,
                                  uint32_t cell,
                                  const uint32_t** objects,
                                  size_t* count) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        require(objects, "objects");
        require(count, "count");
        require_index(cell, object->sets.cells().size(), "cell");
        const auto& visible = object->sets.sets()[cell];
        *objects = visible.data();
        *count = visible.size();
    });
}

es_status es_visible_sets_triangles(
    es_visible_sets sets, uint32_t cell, uint32_t* triangles, size_t capacity, size_t* count) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        require(count, "count");
        require_index(cell, object->sets.cells().size(), "cell");
        const auto out = require_array(triangles, capacity, "triangles");
        const auto visible = object->sets.triangles_visible_from(cell);
        std::copy_n(visible.begin(), std::min(out.size(), visible.size()), out.begin());
        *count = visible.size();
    });
}

es_status es_visible_sets_object_of_triangle(es_visible_sets sets,
                                             const uint32_t** objects,
                                             size_t* count) {
    return call(__func__, [&] {
        const Reading<VisibleSetsObject> object(sets, "sets");
        require(objects, "objects");
        const auto of_triangle = object->sets.objects().object_of_triangle();
        require(count, "count") = of_triangle.size();
        *objects = of_triangle.data();
    });
}
