// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/internal/sample_source.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Draws, casts and counts batches of samples.
class GlobalSampler {
public:
    GlobalSampler(const bvh::WideTree& tree,
                  const geometry::MeshView& mesh,
                  const Objects& objects,
                  const ViewCells& cells,
                  const GlobalSamplingOptions& options,
                  Executor& executor);

    GlobalPvs run();

private:
    /// An entry that a sample may add.
    struct Find {
        std::uint32_t sample;
        CellId cell;
        ObjectId object;
        bool is_ahead;  ///< at the end that the line points to
    };
    /// What the samples of the last half of the work tell of what is missing.
    struct Mark {
        std::uint64_t rays, own_samples, own_finds;
    };

    bool is_finished() const;
    std::vector<Sample> draw_batch();
    SampleDistribution choose(double die) const;
    std::vector<Find> look(std::span<const Sample> samples, std::span<const FreeSegment> segments);
    void take_in(std::span<const Sample> samples,
                 std::span<const FreeSegment> segments,
                 std::span<const Find> finds);
    void note_candidates(const FreeSegment& segment, bool ahead, bool behind);
    void follow_silhouette(const Sample& sample, const FreeSegment& segment);
    void choose_anew(const std::array<GlobalPvs::Count, kSampleDistributions>& before);
    void close_window();
    std::vector<ObjectId> set_of(CellId cell) const;

    std::uint64_t& word(CellId cell, ObjectId object) { return bits_[cell * words_ + object / 64]; }
    bool is_known(CellId cell, ObjectId object) const {
        return (bits_[cell * words_ + object / 64] >> object % 64 & 1U) != 0;
    }
    double radius_at(geometry::TriangleId triangle) const;

    const bvh::WideTree& tree_;
    geometry::MeshView mesh_;
    const Objects& objects_;
    const ViewCells& cells_;
    const GlobalSamplingOptions& options_;
    Executor& executor_;
    SampleSource source_;
    MutationStore store_;
    std::size_t words_;                 // of bits, per cell
    std::vector<std::uint64_t> bits_;   // cell after cell
    std::vector<std::uint64_t> sizes_;  // per cell
    std::array<double, kSampleDistributions> chances_{};
    GlobalPvs view_;
    std::uint64_t entries_ = 0;
    std::uint64_t own_finds_ = 0;  // by view_space_direction for the cell of their origin
    std::vector<Mark> marks_;
    std::uint64_t window_end_;
    std::vector<std::uint64_t> sizes_then_;  // when the window began
    bool has_converged_ = false;
    bool is_interrupted_ = false;
};

}  // namespace earshot::visibility
