// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/view_cells.h"

#include <array>
#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// Where samples come from.
enum class SampleKind {
    view_direction,      ///< from anywhere in the region, to all sides
    object_direction,    ///< from anywhere on an object, after Lambert
    two_point,           ///< from anywhere in the region to anywhere on an object
    two_point_mutation,  ///< beside a sample that found something
    silhouette_mutation  ///< just by the object that a sample found
};

inline constexpr std::size_t kSampleKinds = 5;

struct GlobalOptions {
    std::uint64_t seed = 1;
    std::uint64_t most_rays = 20'000'000;  ///< two to a sample
    /// The work ends when in `window` rays no cell's set grew by more than `most_growth`.
    std::uint64_t window = 5'000'000;
    std::uint64_t most_growth = 5;
    std::size_t samples_per_batch = std::size_t{1} << 16U;
    /// Which kinds may be drawn, by SampleKind; to compare with.
    std::array<bool, kSampleKinds> kinds = {true, true, true, true, true};
    Progress* progress = nullptr;  ///< told of "rays"
    Interrupt interrupt{};         ///< asked between batches; the result is then what was found
};

/// What all cells of a region see, as far as rays tell: subsets of all (aggressive sets).
struct GlobalView {
    std::vector<std::vector<ObjectId>> visible;  ///< per cell, ascending
    std::uint64_t rays = 0;
    /// Of the samples from anywhere in the region to all sides, in the last half of the work: the
    /// share that added to the set of the cell they came from (Bittner et al. 2009, section 5.3).
    double missed_share = 0.0;
    struct Point {
        std::uint64_t rays, entries;
    };
    std::vector<Point> curve;  ///< how the sets grew together, after every batch
    struct Count {
        std::uint64_t samples = 0;
        std::uint64_t finds = 0;  ///< entries that were added
    };
    std::array<Count, kSampleKinds> counts{};
};

/// Fills the sets of all cells at the same time (Bittner et al. 2009, adaptive global visibility
/// sampling): a line tells every cell that it passes what it meets at its ends, and lines are drawn
/// from the kinds that found the most lately, per ray that they cost. The sets depend on what is
/// given alone, unless it is interrupted. Throws Error if the sets would take more than 4 GiB while
/// they grow (a bit for every cell and object), or no kind may be drawn. Precondition: the tree was
/// built over or refitted to this mesh; objects are of its triangles.
GlobalView sample_cells(const bvh::WideTree& tree,
                        const geometry::MeshView& mesh,
                        const Objects& objects,
                        const ViewCells& cells,
                        const GlobalOptions& options = {},
                        Executor& executor = Executor::serial());

}  // namespace earshot::visibility
