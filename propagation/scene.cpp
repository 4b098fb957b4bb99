// SPDX-License-Identifier: MIT
#include "earshot/propagation/scene.h"

namespace earshot::propagation {

geometry::Vec3 Scene::position_at(const Emitter& emitter, double t) const {
    if (emitter.node < 0) {
        return emitter.position;
    }
    return geometry::transform_point(mesh.node_transform(emitter.node, t), emitter.position);
}

}  // namespace earshot::propagation
