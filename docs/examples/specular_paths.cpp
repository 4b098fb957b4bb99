// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"
#include "earshot/frustum/trace.h"
#include "earshot/geometry/clean.h"
#include "earshot/io/scene_file.h"

#include <iostream>

int main() {
    using namespace earshot;
    const propagation::Scene scene = io::load_scene("scenes/shoebox.gltf").scene;

    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(0.0);
    const geometry::MeshView mesh{positions, scene.mesh.triangles()};
    const geometry::CleanMesh clean = geometry::clean(mesh);
    const geometry::Facets facets =
        geometry::find_facets(mesh, clean.weld, scene.material_of_triangle);
    const bvh::Tree tree = bvh::Tree::build(bvh::triangle_boxes(mesh));

    const geometry::Vec3 source = scene.position_at(scene.sources.front(), 0.0);
    const geometry::Vec3 listener = scene.position_at(scene.listeners.front(), 0.0);
    const frustum::TraceResult result = frustum::find_specular_paths(
        {tree, mesh, facets, {}}, source, {&listener, 1}, {.max_order = 2});
    for (const frustum::SpecularPath& path : result.paths) {
        std::cout << path.length << " m, " << path.triangles.size() << " reflections\n";
    }
}
