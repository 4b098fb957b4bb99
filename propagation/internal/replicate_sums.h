// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Coarse intervals of a histogram: the first bin of each, and the number of bins. They last about
/// 4 ms, as fine as a decay or the limit of an early time need, up to 0.4 s; then ever longer, as a
/// decay that lasts so long is slow.
std::vector<std::size_t> coarse_intervals(std::size_t bins, double bin);

/// Sums of the batches of one listener in coarse intervals and in groups of equally many successive
/// batches: replicates of the experiment. A group has as many batches, a power of two, as it takes
/// for at most kMaxReplicates complete groups; the batches after the last complete group belong to
/// no replicate. Both depend on the number of batches alone.
class ReplicateSums {
public:
    static constexpr std::size_t kMaxReplicates = 64;
    static constexpr std::size_t kMinReplicates = 4;

    /// Of a histogram of `bins` bins of `bin` seconds, in `bands` bands.
    ReplicateSums(std::size_t bins, double bin, std::size_t bands);

    /// Adds a batch with its weight: energy and the share of it that the air leaves, per bin and
    /// band.
    void add(std::span<const double> energy, std::span<const double> air_loss, double weight);

    /// First bin of each interval, and the number of bins.
    std::span<const std::size_t> first_bin() const noexcept { return first_bin_; }
    /// Complete groups.
    std::size_t count() const noexcept { return groups_.size(); }
    /// Mean over the batches of a group in an interval.
    double energy(std::size_t group, std::size_t interval, std::size_t band) const noexcept {
        return groups_[group].energy[interval * bands_ + band] / groups_[group].weight;
    }
    /// Empty with fewer than kMinReplicates batches.
    audio::HistogramReplicates replicates() const;

private:
    struct Group {
        double weight = 0.0;
        std::vector<double> energy;  // per interval and band, times the weight
    };

    void merge(Group& into, const Group& other) const;
    void merge_pairs();

    std::size_t bands_;
    std::vector<std::size_t> first_bin_;
    std::size_t group_size_ = 1;  // batches
    std::vector<Group> groups_;   // the complete ones
    Group begun_;
    std::size_t batches_begun_ = 0;  // in it
};

}  // namespace earshot::propagation
