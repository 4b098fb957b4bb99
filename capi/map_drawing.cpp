// SPDX-License-Identifier: MIT
// Pictures of maps.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/map_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/io/map_picture.h"
#include "earshot/io/whole_file.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

using namespace earshot;
using namespace earshot::capi;

es_status es_map_draw(es_metric_map map,
                      size_t source,
                      size_t metric,
                      es_scene scene,
                      double limit,
                      const char* file) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require_index(source, object->map.sources.size(), "source");
        require_index(metric, object->map.metrics.size(), "metric");
        std::optional<propagation::MapLimit> drawn_limit;
        if (!std::isnan(limit)) {
            require_map_limit(limit, "limit");
            drawn_limit = {.metric = metric, .value = limit};
        }
        const std::string path(require_text(file, "file"));
        const bool is_svg = path.ends_with(".svg");
        if (!is_svg && !path.ends_with(".png")) {
            fail_argument("file", "ends in neither .svg nor .png", "name such a file");
        }
        std::optional<Reading<SceneObject>> walls;
        std::vector<geometry::Vec3> positions;
        geometry::MeshView mesh{};
        if (scene != 0) {
            walls.emplace(scene, "scene");
            const geometry::AnimatedMesh& all = (*walls)->loaded.scene.mesh;
            positions = all.positions_at(object->map.time);
            mesh = {positions, all.triangles()};
        }
        const io::MapDrawing drawing = {
            .map = object->map,
            .source = source,
            .metric = metric,
            .mesh = mesh,
            .limit = drawn_limit,
            .title = io::map_title(object->scene, object->map, source, metric)};
        if (is_svg) {
            io::write_whole_file(path, io::draw_map_svg(drawing));
        } else {
            io::write_png(path, io::draw_map_picture(drawing));
        }
    });
}
