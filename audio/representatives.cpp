// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/representatives.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

// Bins up to here are nodes one by one, from kSeriesBegin on in a geometric series. With a third
// fewer nodes, filters whose bands are independent err by 10 dB more between the nodes.
constexpr std::size_t kSeriesBegin = 8;
constexpr double kSeriesRatio = 1.11;

// Filters among which pivots are looked for first; the others only join where they turn out to lie
// outside. 512 vectors stay in the cache.
constexpr std::size_t kSample = 512;
constexpr int kRounds = 6;

// The remainder 1 - sum c^2 has lost its last digits; what is certainly below the bound counts.
constexpr double kMaxRemainder = kRepresentativeError * kRepresentativeError * (1.0 + 1e-4) + 1e-13;

std::vector<std::size_t> node_bins(const ArrivalFilter& filter) {
    const std::size_t last = filter.fft().bins() - 1;
    std::vector<std::size_t> bins = {0, 1, 2, 3, 4, 6, last};
    for (double bin = kSeriesBegin; bin < static_cast<double>(last); bin *= kSeriesRatio) {
        bins.push_back(static_cast<std::size_t>(bin));
    }
    bins.insert(bins.end(), filter.centre_bins().begin(), filter.centre_bins().end());
    std::sort(bins.begin(), bins.end());
    bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
    return bins;
}

}  // namespace

FilterNodes::FilterNodes(const ArrivalFilter& filter) : bands_(filter.bands_in_use()) {
    const FilterRows rows = filter.rows();
    const std::vector<std::size_t> bins = node_bins(filter);
    for (std::size_t k = 0; k < bins.size(); ++k) {
        const std::size_t bin = bins[k];
        const auto segment = std::find_if(rows.segments.begin(),
                                          rows.segments.end(),
                                          [&](const FilterSegment& s) { return bin < s.end; });
        lower_band_.push_back(static_cast<std::uint32_t>(segment->lower_band));
        upper_weight_.push_back(rows.upper_weight[bin]);
        // A node stands for the bins that are closer to it than to its neighbours.
        const double at = static_cast<double>(bin);
        const double begin = k == 0 ? -0.5 : 0.5 * (at + static_cast<double>(bins[k - 1]));
        const double end =
            k + 1 == bins.size() ? at + 0.5 : 0.5 * (at + static_cast<double>(bins[k + 1]));
        weight_.push_back(std::sqrt(end - begin));
        for (std::size_t band = 0; band < bands_; ++band) {
            phase_.push_back(rows.phase_of_band[band * rows.stride + bin]);
        }
    }
}

NodeRows FilterNodes::rows() const noexcept {
    return {.bands = bands_,
            .count = weight_.size(),
            .lower_band = lower_band_.data(),
            .upper_weight = upper_weight_.data(),
            .weight = weight_.data(),
            .phase = phase_.data()};
}

void log_pressures(std::span<const Spectrum* const> spectra,
                   std::size_t bands,
                   std::vector<double>& largest,
                   LargeArray<double>& logs) {
    // kLanes spectra side by side, and a last row of zeros.
    const std::size_t group_size = (bands + 1) * kLanes;
    logs.assign(padded(spectra.size()) * (bands + 1), 1.0);
    largest.clear();
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        const auto used = std::span(*spectra[i]).first(bands);
        largest.push_back(*std::max_element(used.begin(), used.end()));
        double* column = &logs[i / kLanes * group_size + i % kLanes];
        for (std::size_t band = 0; band < bands; ++band) {
            column[band * kLanes] = std::max(used[band] / largest[i], kPressureFloor);
        }
    }
    logarithms(logs.data(), logs.size());
}

bool Representatives::find(const NodeRows& nodes,
                           std::span<const double> log_pressure,
                           std::size_t count,
                           std::size_t max_pivots) {
    make_vectors(nodes, log_pressure, count);
    pivots_.clear();
    for (int round = 0; round < kRounds; ++round) {
        if (!choose_pivots(max_pivots)) {
            return false;
        }
        if (!extend_sample()) {
            break;
        }
    }
    outside_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (remainders_[i] > kMaxRemainder) {
            outside_.push_back(i);
        }
    }
    make_weights(count);
    return true;
}

void Representatives::make_vectors(const NodeRows& nodes,
                                   std::span<const double> log_pressure,
                                   std::size_t count) {
    const std::size_t all = padded(count);
    size_ = vector_size(nodes.count);
    vectors_.resize(all * size_);
    norms_.resize(all);
    const std::size_t logs = (nodes.bands + 1) * kLanes;
    const std::size_t step = (count + kSample - 1) / kSample;
    sampled_.resize(all / kLanes);
    for (std::size_t group = 0; group < groups(); ++group) {
        node_vectors(nodes,
                     &log_pressure[group * logs],
                     &vectors_[group * kLanes * size_],
                     &norms_[group * kLanes]);
        sampled_[group] = group % step == 0 ? 1 : 0;
    }
    projected_.assign(groups(), 0);
    remainders_.assign(all, 1.0);
    std::fill(remainders_.begin() + static_cast<std::ptrdiff_t>(count), remainders_.end(), -1.0);
}

bool Representatives::choose_pivots(std::size_t max_pivots) {
    for (;;) {
        // The largest remainder of the sample, the first of equals.
        std::size_t farthest = 0;
        double remainder = kMaxRemainder;
        for (std::size_t i = 0; i < remainders_.size(); ++i) {
            if (remainders_[i] > remainder && sampled_[i / kLanes] != 0) {
                remainder = remainders_[i];
                farthest = i;
            }
        }
        if (!(remainder > kMaxRemainder)) {
            return true;
        }
        if (pivots_.size() == max_pivots) {
            return false;
        }
        add_pivot(farthest);
    }
}

// The pivot's remainder becomes the next row of the basis, onto which the sample is projected.
void Representatives::add_pivot(std::size_t filter) {
    const std::size_t pivot = pivots_.size();
    pivots_.push_back(filter);
    basis_.resize(pivots_.size() * size_);
    coefficients_.resize(pivots_.size() * groups() * kLanes);
    double* row = &basis_[pivot * size_];
    const std::size_t group_of_pivot = filter / kLanes;
    const double* vector = &vectors_[group_of_pivot * kLanes * size_ + filter % kLanes];
    for (std::size_t k = 0; k < size_; ++k) {
        row[k] = vector[k * kLanes];
    }
    orthogonalise(basis_.data(), size_, pivot, row);

    sample_vectors_.clear();
    sample_coefficients_.clear();
    sample_remainders_.clear();
    for (std::size_t group = 0; group < groups(); ++group) {
        if (sampled_[group] != 0) {
            sample_vectors_.push_back(&vectors_[group * kLanes * size_]);
            sample_coefficients_.push_back(coefficients_of(pivot, group));
            sample_remainders_.push_back(&remainders_[group * kLanes]);
            projected_[group] = pivots_.size();
        }
    }
    project_groups(sample_vectors_.data(),
                   row,
                   size_,
                   sample_vectors_.size(),
                   sample_coefficients_.data(),
                   sample_remainders_.data());
}

// Projects everything onto the whole basis. Groups with a filter outside join the sample; whether
// there are any.
bool Representatives::extend_sample() {
    bool more = false;
    for (std::size_t group = 0; group < groups(); ++group) {
        const std::size_t first = projected_[group];
        double* remainders = &remainders_[group * kLanes];
        if (first < pivots_.size()) {
            project(&vectors_[group * kLanes * size_],
                    &basis_[first * size_],
                    size_,
                    pivots_.size() - first,
                    groups() * kLanes,
                    coefficients_of(first, group),
                    remainders);
            projected_[group] = pivots_.size();
        }
        if (*std::max_element(remainders, remainders + kLanes) > kMaxRemainder) {
            sampled_[group] = 1;
            more = true;
        }
    }
    return more;
}

void Representatives::make_weights(std::size_t count) {
    const std::size_t rank = pivots_.size();
    // Row per pivot: the coefficients of its vector, which has none past its own.
    triangle_.assign(rank * rank, 0.0);
    for (std::size_t m = 0; m < rank; ++m) {
        for (std::size_t j = 0; j <= m; ++j) {
            const double* row = coefficients_of(j, pivots_[m] / kLanes);
            triangle_[m * rank + j] = row[pivots_[m] % kLanes];
        }
    }
    weights_.resize(padded(count) * rank);
    column_.resize(rank * kLanes);
    for (std::size_t group = 0; group < groups(); ++group) {
        for (std::size_t j = 0; j < rank; ++j) {
            const double* row = coefficients_of(j, group);
            std::copy(row, row + kLanes, &column_[j * kLanes]);
        }
        solve_weights(triangle_.data(), rank, column_.data());
        // The vectors had unit length, the filters have not.
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t filter = group * kLanes + lane;
            for (std::size_t j = 0; j < rank; ++j) {
                weights_[filter * rank + j] =
                    column_[j * kLanes + lane] * (norms_[filter] / norms_[pivots_[j]]);
            }
        }
    }
}

}  // namespace earshot::audio
