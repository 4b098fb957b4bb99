// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/global_sampler.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/visibility/cell_shape.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <numeric>

namespace earshot::visibility {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kSamplesPerChunk = 1024;

// A stream of random numbers: which distribution is drawn.
constexpr std::uint64_t kKind = 90;

// No distribution is drawn more seldom, as what finds nothing now may find something later.
constexpr double kLeastChance = 0.02;

// A silhouette's line that goes on so far, in radii of the object, fell off an edge: Bittner et al.
// 2009, section 4.3.
constexpr double kFallen = 3.0;

constexpr std::size_t at(SampleDistribution distribution) noexcept {
    return static_cast<std::size_t>(distribution);
}

bool is_mutation(SampleDistribution distribution) noexcept {
    return distribution == SampleDistribution::two_point_mutation ||
           distribution == SampleDistribution::silhouette_mutation;
}

}  // namespace

GlobalSampler::GlobalSampler(const bvh::WideTree& tree,
                             const geometry::MeshView& mesh,
                             const Objects& objects,
                             const ViewCells& cells,
                             const GlobalSamplingOptions& options,
                             Executor& executor)
    : tree_(tree),
      mesh_(mesh),
      objects_(objects),
      cells_(cells),
      options_(options),
      executor_(executor),
      source_(mesh, objects, cells.region(), options.seed),
      words_((objects.size() + 63) / 64),
      bits_(words_ * cells.size(), 0),
      sizes_(cells.size(), 0),
      window_end_(options.window),
      sizes_then_(cells.size(), 0) {
    choose_anew({});
}

GlobalPvs GlobalSampler::run() {
    while (!is_finished()) {
        const auto before = view_.counts;
        const std::vector<Sample> samples = draw_batch();
        std::vector<geometry::Ray> rays(samples.size());
        std::transform(
            samples.begin(), samples.end(), rays.begin(), [](const auto& s) { return s.ray; });
        const auto segments = cast_free_segments(tree_, mesh_, rays, cells_.region(), executor_);
        marks_.push_back({view_.rays,
                          view_.counts[at(SampleDistribution::view_space_direction)].samples,
                          own_finds_});
        take_in(samples, segments, look(samples, segments));
        view_.rays += 2 * samples.size();
        view_.curve.push_back({view_.rays, entries_});
        choose_anew(before);
        close_window();
        if (options_.progress != nullptr) {
            options_.progress->report(
                "rays", view_.rays, std::max(view_.rays + 1, options_.max_rays));
        }
        is_interrupted_ = options_.interrupt && options_.interrupt();
    }
    if (options_.progress != nullptr) {
        options_.progress->report("rays", view_.rays, view_.rays);
    }
    const auto half = std::partition_point(
        marks_.begin(), marks_.end(), [&](const Mark& mark) { return 2 * mark.rays < view_.rays; });
    const std::uint64_t own = view_.counts[at(SampleDistribution::view_space_direction)].samples;
    if (half != marks_.end() && own > half->own_samples) {
        view_.missed_share = static_cast<double>(own_finds_ - half->own_finds) /
                             static_cast<double>(own - half->own_samples);
    }
    view_.visible.resize(cells_.size());
    executor_.for_each(cells_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            view_.visible[cell] = set_of(static_cast<CellId>(cell));
        }
    });
    return std::move(view_);
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
           view_.rays + 2 > options_.max_rays;
}

SampleDistribution GlobalSampler::choose(double die) const {
    std::size_t distribution = 0;
    while (distribution + 1 < kSampleDistributions && die >= chances_[distribution]) {
        die -= chances_[distribution];
        ++distribution;
    }
    // A rounding may lead past the last distribution that may be drawn.
    while (!options_.distributions[distribution]) {
        distribution = (distribution + kSampleDistributions - 1) % kSampleDistributions;
    }
    return static_cast<SampleDistribution>(distribution);
}

std::vector<Sample> GlobalSampler::draw_batch() {
    const std::uint64_t allowed = (options_.max_rays - view_.rays) / 2;
    std::vector<Sample> samples(static_cast<std::size_t>(
        std::min<std::uint64_t>(std::max<std::size_t>(1, options_.samples_per_batch), allowed)));
    std::vector<std::uint64_t> index(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        SampleDistribution distribution = choose(random(options_.seed, kKind, view_.rays / 2 + i));
        if (is_mutation(distribution)) {
            samples[i].origin = store_.take();
            // Nothing was found yet that could be varied.
            distribution = samples[i].origin ? distribution : SampleDistribution::two_point;
        }
        samples[i].distribution = distribution;
        index[i] = view_.counts[at(distribution)].samples++;
    }
    executor_.for_each(samples.size(), kSamplesPerChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            source_.draw(samples[i], index[i]);
        }
    });
    return samples;
}

// What is not known yet, in the order of samples, cells and ends.
std::vector<GlobalSampler::Find> GlobalSampler::look(std::span<const Sample> samples,
                                                     std::span<const FreeSegment> segments) {
    const double slack = plane_slack(cells_.region());
    std::vector<std::vector<Find>> parts(chunk_count(samples.size(), kSamplesPerChunk));
    executor_.for_each(samples.size(), kSamplesPerChunk, [&](std::size_t begin, std::size_t end) {
        std::vector<Find>& finds = parts[begin / kSamplesPerChunk];
        std::vector<CellId> pierced;
        for (std::size_t i = begin; i < end; ++i) {
            if (!segments[i].is_valid()) {
                continue;
            }
            cells_.pierced(shortened(segments[i].segment, slack), pierced);
            for (const CellId cell : pierced) {
                for (const bool is_ahead : {false, true}) {
                    const TriangleId met = is_ahead ? segments[i].at_to : segments[i].at_from;
                    if (met != kNoTriangle && !is_known(cell, objects_.of(met))) {
                        finds.push_back(
                            {static_cast<std::uint32_t>(i), cell, objects_.of(met), is_ahead});
                    }
                }
            }
        }
    });
    std::vector<Find> all;
    for (const std::vector<Find>& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

void GlobalSampler::take_in(std::span<const Sample> samples,
                            std::span<const FreeSegment> segments,
                            std::span<const Find> finds) {
    for (std::size_t k = 0; k < finds.size();) {
        const std::uint32_t i = finds[k].sample;
        bool ahead = false;
        bool behind = false;
        std::uint64_t added = 0;
        bool is_for_own_cell = false;
        const auto own = samples[i].distribution == SampleDistribution::view_space_direction
                             ? cells_.cell_at(samples[i].ray.origin)
                             : std::nullopt;
        for (; k < finds.size() && finds[k].sample == i; ++k) {
            const Find& find = finds[k];
            // An earlier sample of the batch may have found the same.
            if (is_known(find.cell, find.object)) {
                continue;
            }
            word(find.cell, find.object) |= std::uint64_t{1} << find.object % 64;
            ++sizes_[find.cell];
            ++added;
            (find.is_ahead ? ahead : behind) = true;
            is_for_own_cell = is_for_own_cell || own == find.cell;
        }
        entries_ += added;
        own_finds_ += is_for_own_cell ? 1 : 0;
        view_.counts[at(samples[i].distribution)].contribution += added;
        if (added > 0) {
            note_candidates(segments[i], ahead, behind);
            if (samples[i].distribution == SampleDistribution::silhouette_mutation) {
                follow_silhouette(samples[i], segments[i]);
            }
        }
    }
}

double GlobalSampler::radius_at(TriangleId triangle) const {
    if (triangle != kNoTriangle) {
        return source_.radius(objects_.of(triangle));
    }
    // About that of a cell.
    return 0.5 * glm::length(cells_.region().size()) /
           math::pow(static_cast<double>(cells_.size()), 1.0 / 3.0);
}

void GlobalSampler::note_candidates(const FreeSegment& free, bool ahead, bool behind) {
    if (free.segment.from == free.segment.to) {
        return;
    }
    if (ahead) {
        store_.add(
            {free.segment.from, free.segment.to, objects_.of(free.at_to), radius_at(free.at_from)});
    }
    if (behind) {
        store_.add(
            {free.segment.to, free.segment.from, objects_.of(free.at_from), radius_at(free.at_to)});
    }
}

// Far behind the object's border something else came into view; seen from there the object is a
// silhouette again.
void GlobalSampler::follow_silhouette(const Sample& sample, const FreeSegment& free) {
    const ObjectId object = sample.origin->object;
    if (free.at_to == kNoTriangle || objects_.of(free.at_to) == object ||
        !(glm::distance(free.segment.to, sample.aimed_at) > kFallen * source_.radius(object))) {
        return;
    }
    if (free.segment.to != sample.origin->to) {
        store_.add({free.segment.to, sample.origin->to, object, radius_at(free.at_to)});
    }
}

// In proportion to what each distribution found for its rays in the last batch, but never too
// seldom.
void GlobalSampler::choose_anew(const std::array<GlobalPvs::Count, kSampleDistributions>& before) {
    std::array<double, kSampleDistributions> weights{};
    for (std::size_t distribution = 0; distribution < kSampleDistributions; ++distribution) {
        const auto samples =
            static_cast<double>(view_.counts[distribution].samples - before[distribution].samples);
        const auto finds = static_cast<double>(view_.counts[distribution].contribution -
                                               before[distribution].contribution);
        weights[distribution] = !options_.distributions[distribution] ? 0.0
                                : samples > 0.0                       ? finds / samples
                                                                      : 0.0;
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto distributions = static_cast<double>(
        std::count(options_.distributions.begin(), options_.distributions.end(), true));
    double total = 0.0;
    for (std::size_t distribution = 0; distribution < kSampleDistributions; ++distribution) {
        chances_[distribution] =
            !options_.distributions[distribution]
                ? 0.0
                : std::max(kLeastChance,
                           sum > 0.0 ? weights[distribution] / sum : 1.0 / distributions);
        total += chances_[distribution];
    }
    for (double& chance : chances_) {
        chance /= total;
    }
}

void GlobalSampler::close_window() {
    if (view_.rays < window_end_) {
        return;
    }
    std::uint64_t most = 0;
    for (std::size_t cell = 0; cell < sizes_.size(); ++cell) {
        most = std::max(most, sizes_[cell] - sizes_then_[cell]);
    }
    has_converged_ = most <= options_.max_growth;
    sizes_then_ = sizes_;
    window_end_ = view_.rays + options_.window;
}

}  // namespace earshot::visibility
