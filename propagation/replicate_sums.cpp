// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/replicate_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

std::vector<std::size_t> coarse_intervals(std::size_t bins, double bin) {
    constexpr double kShortest = 0.004, kEqualUntil = 0.4;  // seconds
    constexpr double kGrowth = 1.03;
    std::vector<std::size_t> first_bin = {0};
    double length = kShortest / bin;
    double end = 0.0;
    while (first_bin.back() < bins) {
        length *= end * bin < kEqualUntil ? 1.0 : kGrowth;
        end += length;
        const auto whole =
            static_cast<std::size_t>(std::min(std::round(end), static_cast<double>(bins)));
        if (whole > first_bin.back()) {
            first_bin.push_back(whole);
        }
    }
    return first_bin;
}

ReplicateSums::ReplicateSums(std::size_t bins, double bin, std::size_t bands)
    : bands_(bands), first_bin_(coarse_intervals(bins, bin)) {}

void ReplicateSums::merge(Group& into, const Group& other) const {
    into.weight += other.weight;
    into.energy.resize(other.energy.size());
    for (std::size_t i = 0; i < other.energy.size(); ++i) {
        into.energy[i] += other.energy[i];
    }
}

void ReplicateSums::merge_pairs() {
    group_size_ *= 2;
    for (std::size_t i = 0; i < groups_.size() / 2; ++i) {
        Group merged = std::move(groups_[2 * i]);
        merge(merged, groups_[2 * i + 1]);
        groups_[i] = std::move(merged);
    }
    if (groups_.size() % 2 != 0) {
        begun_ = std::move(groups_.back());
        batches_begun_ = group_size_ / 2;
    }
    groups_.resize(groups_.size() / 2);
}

void ReplicateSums::add(std::span<const double> energy,
                        std::span<const double> air_loss,
                        double weight) {
    Group batch{.weight = weight, .energy = std::vector<double>((first_bin_.size() - 1) * bands_)};
    for (std::size_t interval = 0; interval + 1 < first_bin_.size(); ++interval) {
        double* sums = batch.energy.data() + interval * bands_;
        for (std::size_t n = first_bin_[interval]; n < first_bin_[interval + 1]; ++n) {
            for (std::size_t band = 0; band < bands_; ++band) {
                const std::size_t i = n * bands_ + band;
                sums[band] += weight * (air_loss[i] * energy[i]);
            }
        }
    }
    merge(begun_, batch);
    if (++batches_begun_ < group_size_) {
        return;
    }
    groups_.push_back(std::exchange(begun_, {}));
    batches_begun_ = 0;
    if (groups_.size() > kMaxReplicates) {
        merge_pairs();
    }
}

audio::HistogramReplicates ReplicateSums::replicates() const {
    if (groups_.size() < kMinReplicates) {
        return {};
    }
    audio::HistogramReplicates result{.first_bin = first_bin_};
    for (std::size_t group = 0; group < groups_.size(); ++group) {
        std::vector<audio::Spectrum>& energies = result.energy.emplace_back(first_bin_.size() - 1);
        for (std::size_t interval = 0; interval < energies.size(); ++interval) {
            for (std::size_t band = 0; band < bands_; ++band) {
                energies[interval][band] = energy(group, interval, band);
            }
        }
    }
    return result;
}

}  // namespace earshot::propagation
