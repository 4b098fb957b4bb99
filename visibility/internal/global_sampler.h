// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/global_pvs.h"
#include "earshot/visibility/internal/sample_generator.h"
#include "earshot/visibility/view_cells.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Draws and casts batches of samples and adds their contributions to the visible sets.
class GlobalSampler {
public:
    GlobalSampler(const bvh::MeshBvh& bvh,
                  const Objects& objects,
                  const ViewCells& cells,
                  const GlobalSamplingOptions& options,
                  Executor& executor);

    GlobalPvs run();

private:
    /// An entry that a sample may add to a set.
    struct Contribution {
        std::uint32_t sample;
        CellId cell;
        ObjectId object;
        bool is_ahead;  ///< at the end that the ray points to
    };

    bool is_finished() const;
    std::vector<Sample> draw_batch();
    SampleDistribution select_distribution(double uniform) const;
    std::vector<Contribution> find_contributions(std::span<const Sample> samples,
                                                 std::span<const FreeSegment> segments);
    void add_contributions(std::span<const Sample> samples,
                           std::span<const FreeSegment> segments,
                           std::span<const Contribution> contributions);
    void add_candidates(const FreeSegment& segment, bool ahead, bool behind);
    void follow_silhouette(const Sample& sample, const FreeSegment& segment);
    void update_probabilities(const std::array<GlobalPvs::Count, kSampleDistributions>& before);
    void check_convergence();
    std::vector<ObjectId> set_of(CellId cell) const;

    std::uint64_t& word(CellId cell, ObjectId object) { return bits_[cell * words_ + object / 64]; }
    bool is_in_set(CellId cell, ObjectId object) const {
        return (bits_[cell * words_ + object / 64] >> object % 64 & 1U) != 0;
    }
    double radius_at(geometry::TriangleId triangle) const;

    bvh::MeshBvh bvh_;
    const Objects& objects_;
    const ViewCells& cells_;
    const GlobalSamplingOptions& options_;
    Executor& executor_;
    ExclusionMask excluded_;  // triangles without area, too
    SampleGenerator generator_;
    MutationCandidates candidates_;
    std::size_t words_;                 // 64-bit words per cell
    std::vector<std::uint64_t> bits_;   // the set of each cell, a bit per object
    std::vector<std::uint64_t> sizes_;  // of the set of each cell
    std::array<double, kSampleDistributions> probabilities_{};
    GlobalPvs pvs_;
    std::uint64_t entries_ = 0;
    std::uint64_t window_end_;
    std::vector<std::uint64_t> sizes_at_window_start_;  // of the set of each cell
    bool has_converged_ = false;
    bool is_interrupted_ = false;
};

}  // namespace earshot::visibility
