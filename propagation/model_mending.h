// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/model_check.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::propagation {

struct MendingOptions {
    double max_hole_area = 0.05;  ///< square metres; larger holes stay
    double time = 0.0;            ///< seconds, as ModelCheckOptions::time
    /// A scene that moves is copied as it is at `time`; else it is refused.
    bool freeze = false;
};

/// What mending did, by the triangles and holes of the scene that was checked.
struct MendingReport {
    std::size_t welded_vertices = 0;
    std::vector<geometry::TriangleId> degenerate;  ///< removed: without an area
    std::vector<geometry::TriangleId> doubled;     ///< removed: copies of earlier ones
    std::vector<geometry::TriangleId> unreached;   ///< removed: proved to be out of reach
    /// Kept: rays did not reach them, but nothing proves them to be out of reach.
    std::vector<geometry::TriangleId> doubtful;
    std::vector<geometry::TriangleId> turned;  ///< their fronts now face the air
    struct FilledHole {
        std::size_t hole = 0;       ///< index into MeshTopology::holes
        std::size_t triangles = 0;  ///< that were added at the end
    };
    std::vector<FilledHole> filled;
    /// The largest distance of a coordinate from what single precision, as of glTF, keeps of it,
    /// metres.
    double max_rounding = 0.0;
};

struct MendedModel {
    Scene scene;
    MendingReport report;
};

/// Throws the Error of mend_model() for a scene that moves.
void require_still(const Scene& scene);

/// A copy of the scene in which equal vertices are one, triangles face the air, and what takes no
/// part is gone: triangles without area, doubled ones, and those that a closed surface is proved to
/// keep from every source and listener. What sampling alone did not reach stays. Holes that are no
/// outlines and not larger than asked are filled with the material beside them. `report` is that of
/// this scene at the same time. Throws Error for a scene that moves, whose triangles may be needed
/// at another instant, unless its copy shall stand still.
MendedModel mend_model(const Scene& scene,
                       const ModelReport& report,
                       const MendingOptions& options = {});

}  // namespace earshot::propagation
