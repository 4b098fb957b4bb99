// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/global_sampler.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/visibility/cell_shape.h"
#include "earshot/visibility/internal/masked_hits.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <numeric>

namespace earshot::visibility {

using geometry::TriangleId;

namespace {

constexpr std::size_t kSamplesPerChunk = 1024;

// The stream of random numbers that selects distributions.
constexpr std::uint64_t kDistribution = 90;

// The least probability of a distribution: one that contributes nothing now may do so later.
constexpr double kMinProbability = 0.02;

// A ray past a silhouette that goes on so far, in radii of the object, passed a depth
// discontinuity: Bittner et al. 2009, section 4.3.
constexpr double kDepthDiscontinuity = 3.0;

constexpr std::size_t at(SampleDistribution distribution) noexcept {
    return static_cast<std::size_t>(distribution);
}

bool is_mutation(SampleDistribution distribution) noexcept {
    return distribution == SampleDistribution::two_point_mutation ||
           distribution == SampleDistribution::silhouette_mutation;
}

}  // namespace

GlobalSampler::GlobalSampler(const bvh::MeshBvh& bvh,
                             const Objects& objects,
                             const ViewCells& cells,
                             const GlobalSamplingOptions& options,
                             Executor& executor)
    : bvh_(bvh),
      objects_(objects),
      cells_(cells),
      options_(options),
      executor_(executor),
      excluded_(with_degenerate(options.excluded, bvh.mesh())),
      generator_(bvh.mesh(), objects, cells.region(), options.seed),
      words_((objects.size() + 63) / 64),
      bits_(words_ * cells.size(), 0),
      sizes_(cells.size(), 0),
      window_end_(options.window),
      sizes_at_window_start_(cells.size(), 0) {
    update_probabilities({});
}

GlobalPvs GlobalSampler::run() {
    while (!is_finished()) {
        const auto before = pvs_.counts;
        const std::vector<Sample> samples = draw_batch();
        std::vector<geometry::Ray> rays(samples.size());
        std::transform(
            samples.begin(), samples.end(), rays.begin(), [](const auto& s) { return s.ray; });
        const auto segments = cast_free_segments(bvh_, rays, cells_.region(), excluded_, executor_);
        add_contributions(samples, segments, find_contributions(samples, segments));
        pvs_.rays += 2 * samples.size();
        pvs_.curve.push_back({pvs_.rays, entries_});
        update_probabilities(before);
        check_convergence();
        if (options_.progress != nullptr) {
            options_.progress->report(
                "rays", pvs_.rays, std::max(pvs_.rays + 1, options_.max_rays));
        }
        is_interrupted_ = options_.interrupt && options_.interrupt();
    }
    if (options_.progress != nullptr) {
        options_.progress->report("rays", pvs_.rays, pvs_.rays);
    }
    pvs_.visible.resize(cells_.size());
    executor_.for_each(cells_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            pvs_.visible[cell] = set_of(static_cast<CellId>(cell));
        }
    });
    return std::move(pvs_);
}

std::vector<ObjectId> GlobalSampler::set_of(CellId cell) const {
    std::vector<ObjectId> set;
    set.reserve(static_cast<std::size_t>(sizes_[cell]));
    for (std::size_t i = 0; i < words_; ++i) {
        for (std::uint64_t bits = bits_[cell * words_ + i]; bits != 0; bits &= bits - 1) {
            set.push_back(
                static_cast<ObjectId>(64 * i + static_cast<std::size_t>(std::countr_zero(bits))));
        }
    }
    return set;
}

bool GlobalSampler::is_finished() const {
    return has_converged_ || is_interrupted_ || objects_.size() == 0 ||
           pvs_.rays + 2 > options_.max_rays;
}

SampleDistribution GlobalSampler::select_distribution(double uniform) const {
    std::size_t distribution = 0;
    while (distribution + 1 < kSampleDistributions && uniform >= probabilities_[distribution]) {
        uniform -= probabilities_[distribution];
        ++distribution;
    }
    // Rounding may lead past the last distribution that is allowed.
    while (!options_.distributions[distribution]) {
        distribution = (distribution + kSampleDistributions - 1) % kSampleDistributions;
    }
    return static_cast<SampleDistribution>(distribution);
}

std::vector<Sample> GlobalSampler::draw_batch() {
    const std::uint64_t allowed = (options_.max_rays - pvs_.rays) / 2;
    std::vector<Sample> samples(static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max<std::size_t>(1, options_.samples_per_batch), allowed)));
    std::vector<std::uint64_t> index(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        SampleDistribution distribution =
            select_distribution(random(options_.seed, kDistribution, pvs_.rays / 2 + i));
        if (is_mutation(distribution)) {
            samples[i].candidate = candidates_.select();
            // There is no candidate yet.
            distribution = samples[i].candidate ? distribution : SampleDistribution::two_point;
        }
        samples[i].distribution = distribution;
        index[i] = pvs_.counts[at(distribution)].samples++;
    }
    executor_.for_each(samples.size(), kSamplesPerChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            generator_.draw(samples[i], index[i]);
        }
    });
    return samples;
}

// The entries that the sets lacked before the batch, in the order of samples, cells and ends.
std::vector<GlobalSampler::Contribution> GlobalSampler::find_contributions(
    std::span<const Sample> samples, std::span<const FreeSegment> segments) {
    const double slack = plane_slack(cells_.region());
    std::vector<std::vector<Contribution>> parts(chunk_count(samples.size(), kSamplesPerChunk));
    executor_.for_each(samples.size(), kSamplesPerChunk, [&](std::size_t begin, std::size_t end) {
        std::vector<Contribution>& contributions = parts[begin / kSamplesPerChunk];
        std::vector<CellId> pierced;
        for (std::size_t i = begin; i < end; ++i) {
            if (!segments[i].is_valid()) {
                continue;
            }
            cells_.pierced(shortened(segments[i].segment, slack), pierced);
            for (const CellId cell : pierced) {
                for (const bool is_ahead : {false, true}) {
                    const TriangleId triangle = is_ahead ? segments[i].at_to : segments[i].at_from;
                    if (triangle != kNoTriangle && !is_in_set(cell, objects_.of(triangle))) {
                        contributions.push_back(
                            {static_cast<std::uint32_t>(i), cell, objects_.of(triangle), is_ahead});
                    }
                }
            }
        }
    });
    std::vector<Contribution> all;
    for (const std::vector<Contribution>& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

void GlobalSampler::add_contributions(std::span<const Sample> samples,
                                      std::span<const FreeSegment> segments,
                                      std::span<const Contribution> contributions) {
    for (std::size_t k = 0; k < contributions.size();) {
        const std::uint32_t i = contributions[k].sample;
        bool ahead = false;
        bool behind = false;
        std::uint64_t added = 0;
        for (; k < contributions.size() && contributions[k].sample == i; ++k) {
            const Contribution& contribution = contributions[k];
            // An earlier sample of the batch may have added the same.
            if (is_in_set(contribution.cell, contribution.object)) {
                continue;
            }
            word(contribution.cell, contribution.object) |= std::uint64_t{1}
                                                            << contribution.object % 64;
            ++sizes_[contribution.cell];
            ++added;
            (contribution.is_ahead ? ahead : behind) = true;
        }
        entries_ += added;
        pvs_.counts[at(samples[i].distribution)].contribution += added;
        if (added > 0) {
            add_candidates(segments[i], ahead, behind);
            if (samples[i].distribution == SampleDistribution::silhouette_mutation) {
                follow_silhouette(samples[i], segments[i]);
            }
        }
    }
}

double GlobalSampler::radius_at(TriangleId triangle) const {
    if (triangle != kNoTriangle) {
        return generator_.radius(objects_.of(triangle));
    }
    // About the radius of a cell.
    return 0.5 * glm::length(cells_.region().size()) /
           math::pow(static_cast<double>(cells_.size()), 1.0 / 3.0);
}

void GlobalSampler::add_candidates(const FreeSegment& free, bool ahead, bool behind) {
    if (free.segment.from == free.segment.to) {
        return;
    }
    if (ahead) {
        candidates_.add(
            {free.segment.from, free.segment.to, objects_.of(free.at_to), radius_at(free.at_from)});
    }
    if (behind) {
        candidates_.add(
            {free.segment.to, free.segment.from, objects_.of(free.at_from), radius_at(free.at_to)});
    }
}

// The ray hit another object far behind the silhouette. As in reverse sampling, the silhouette is
// mutated again, as seen from that hit.
void GlobalSampler::follow_silhouette(const Sample& sample, const FreeSegment& free) {
    const ObjectId object = sample.candidate->object;
    if (free.at_to == kNoTriangle || objects_.of(free.at_to) == object ||
        !(glm::distance(free.segment.to, sample.silhouette_point) >
          kDepthDiscontinuity * generator_.radius(object))) {
        return;
    }
    if (free.segment.to != sample.candidate->to) {
        candidates_.add({free.segment.to, sample.candidate->to, object, radius_at(free.at_to)});
    }
}

// Bittner et al. 2009, section 4.1: the probability of a distribution is proportional to its
// contribution per sample in the last batch, here with a lower limit.
void GlobalSampler::update_probabilities(
    const std::array<GlobalPvs::Count, kSampleDistributions>& before) {
    std::array<double, kSampleDistributions> weights{};
    for (std::size_t distribution = 0; distribution < kSampleDistributions; ++distribution) {
        const auto samples =
            static_cast<double>(pvs_.counts[distribution].samples - before[distribution].samples);
        const auto contributions = static_cast<double>(pvs_.counts[distribution].contribution -
                                                       before[distribution].contribution);
        weights[distribution] = !options_.distributions[distribution] ? 0.0
                                : samples > 0.0                       ? contributions / samples
                                                                      : 0.0;
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto distributions = static_cast<double>(
        std::count(options_.distributions.begin(), options_.distributions.end(), true));
    double total = 0.0;
    for (std::size_t distribution = 0; distribution < kSampleDistributions; ++distribution) {
        probabilities_[distribution] =
            !options_.distributions[distribution]
                ? 0.0
                : std::max(kMinProbability,
                           sum > 0.0 ? weights[distribution] / sum : 1.0 / distributions);
        total += probabilities_[distribution];
    }
    for (double& probability : probabilities_) {
        probability /= total;
    }
}

void GlobalSampler::check_convergence() {
    if (pvs_.rays < window_end_) {
        return;
    }
    std::uint64_t largest_growth = 0;
    for (std::size_t cell = 0; cell < sizes_.size(); ++cell) {
        largest_growth = std::max(largest_growth, sizes_[cell] - sizes_at_window_start_[cell]);
    }
    has_converged_ = largest_growth <= options_.max_growth;
    sizes_at_window_start_ = sizes_;
    window_end_ = pvs_.rays + options_.window;
}

}  // namespace earshot::visibility
