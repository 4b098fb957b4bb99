// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/moving_early_sound.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/moving_arrivals.h"
#include "earshot/base/stage_progress.h"
#include "earshot/propagation/channel_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

// Blocks of the sound are independent of each other until their buses are filtered: threads make
// the buses of some blocks, which then pass through the filters in order. Every number depends on
// its block alone, so the bits do not depend on the threads.

namespace earshot::propagation {

namespace {

using Signals = std::vector<std::vector<double>>;

constexpr std::size_t kBlock = 4096;  // samples
constexpr std::size_t kStretch = 64;  // over which a delay is a cubic
constexpr std::size_t kBlocksAtOnce = 16;
// Over which two head-related impulse responses are cross-faded: 11 ms at 48 kHz, in which a source
// at 30 m/s and 3 m turns by 6 degrees.
constexpr std::size_t kHrirStretch = 512;

/// The filters of all paths at all instants.
struct PathFilters {
    audio::FilterBank bank;
    std::vector<std::size_t> first_of_path;  // of its spectra: those of each instant in turn
};

PathFilters filters_of(const audio::Assembler& assembler, std::span<const MovingPath> paths) {
    std::vector<audio::Spectrum> spectra;
    std::vector<std::size_t> first_of_path;
    for (const MovingPath& path : paths) {
        first_of_path.push_back(spectra.size());
        for (const PathInstant& instant : path.instants) {
            spectra.insert(
                spectra.end(), instant.pressure_at_1_m.begin(), instant.pressure_at_1_m.end());
        }
    }
    return {.bank = audio::FilterBank(assembler, spectra),
            .first_of_path = std::move(first_of_path)};
}

/// The early sound under way.
class Rendering {
public:
    Rendering(const MovingEarlySound& sound, std::span<const double> recording)
        : sound_(sound),
          recording_(recording),
          filters_(filters_of(sound.assembler, sound.paths.paths())),
          channels_(channel_count(sound.format.channels, sound.format.ambisonic_order)),
          rate_(sound.format.sample_rate) {}

    Signals render(Executor& executor, Progress* progress) {
        const std::size_t blocks = (last_sample() + kBlock - 1) / kBlock;
        const std::size_t buses = filters_.bank.filters() * channels_;
        audio::MultiConvolver convolver = filters_.bank.convolver(channels_, kBlock);
        Signals channels(channels_);
        std::vector<std::vector<double>> made(kBlocksAtOnce);
        std::vector<double> out(channels_ * kBlock);
        StageProgress rendered(progress, "sound", std::max<std::size_t>(blocks, 1));
        const auto append = [&](const std::vector<double>& of_buses) {
            convolver.process(of_buses, out);
            for (std::size_t channel = 0; channel < channels_; ++channel) {
                const auto begin = out.begin() + static_cast<std::ptrdiff_t>(channel * kBlock);
                channels[channel].insert(
                    channels[channel].end(), begin, begin + static_cast<std::ptrdiff_t>(kBlock));
            }
        };
        for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
            const std::size_t count = std::min(kBlocksAtOnce, blocks - first);
            executor.for_each(count, 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    made[i].assign(buses * kBlock, 0.0);
                    add_block(first + i, made[i]);
                }
            });
            for (std::size_t i = 0; i < count; ++i) {
                append(made[i]);
            }
            rendered.add(count);
        }
        // What still rings.
        const std::vector<double> silence(buses * kBlock, 0.0);
        for (std::size_t ringing = 0; ringing < longest_filter(); ringing += kBlock) {
            append(silence);
        }
        for (std::vector<double>& channel : channels) {
            channel.resize(last_sample() + longest_filter() - 1);
        }
        return channels;
    }

private:
    double time_of(double sample) const noexcept { return sound_.start + sample / rate_; }

    std::size_t longest_filter() const {
        std::size_t longest = 1;
        for (std::size_t filter = 0; filter < filters_.bank.filters(); ++filter) {
            longest = std::max(longest, filters_.bank.taps(filter).size());
        }
        return longest;
    }

    /// The sample after which no path brings anything.
    std::size_t last_sample() {
        if (last_sample_ == 0) {
            const double end = time_of(static_cast<double>(recording_.size()));
            double longest = 0.0;
            for (const MovingPath& path : sound_.paths.paths()) {
                const double emission = std::min(end, end_of(path));
                // The listener has moved on when the sound arrives: the delay is sought from there.
                double delay = 0.0;
                for (int step = 0; step < 8; ++step) {
                    delay = length_of(sound_.paths.unfolded_at(path, emission),
                                      sound_.source.at(emission),
                                      sound_.listener.at(emission + delay))
                                .length /
                            sound_.speed_of_sound;
                }
                longest = std::max(longest, emission - sound_.start + delay);
            }
            constexpr std::size_t kRoom = 2 * audio::kMovingArrivalLookahead;
            last_sample_ = static_cast<std::size_t>(std::ceil(longest * rate_)) + kRoom +
                           (sound_.hrirs ? kHrirStretch : 0);
        }
        return last_sample_;
    }

    /// What a path brings at the sample, which may lie before the first.
    PathReception receive(const MovingPath& path, double sample, double near) const {
        const double time = time_of(sample);
        return sound_.paths.receive(
            path, sound_.source, sound_.listener.at(time), time, sound_.speed_of_sound, near);
    }

    /// Whether anything of the path is heard from sample `begin` to sample `end`; if so, the first
    /// reception.
    std::optional<PathReception> heard(const MovingPath& path, double begin, double end) const {
        const double late = time_of(begin) - 0.1;
        const PathReception first = receive(path, begin, late);
        const PathReception last = receive(path, end, first.emission);
        const double recorded =
            time_of(static_cast<double>(recording_.size() + audio::kMovingArrivalLookahead));
        const double from = sound_.start - audio::kMovingArrivalLookahead / rate_;
        if (last.emission < std::max(from, path.first == 0 ? from : sound_.paths.begin_of(path)) ||
            first.emission > std::min(recorded, end_of(path))) {
            return std::nullopt;
        }
        return first;
    }

    double end_of(const MovingPath& path) const {
        const bool holds = path.last() + 1 == sound_.paths.times().size();
        return holds ? std::numeric_limits<double>::infinity() : sound_.paths.end_of(path);
    }

    /// Weights of the filters for what was emitted at `emission`.
    void weigh(std::size_t path, double emission, std::span<double> weights) const {
        const PathShare share = sound_.paths.share_at(sound_.paths.paths()[path], emission);
        std::fill(weights.begin(), weights.end(), 0.0);
        const auto add = [&](std::size_t instant, double factor) {
            if (factor == 0.0) {
                return;
            }
            constexpr std::size_t kParts =
                std::tuple_size_v<decltype(PathInstant::pressure_at_1_m)>;
            for (std::size_t part = 0; part < kParts; ++part) {
                const std::span<const double> of_spectrum =
                    filters_.bank.weights(filters_.first_of_path[path] + instant * kParts + part);
                for (std::size_t filter = 0; filter < weights.size(); ++filter) {
                    weights[filter] += factor * of_spectrum[filter];
                }
            }
        };
        add(share.lower, share.of_lower);
        add(share.lower + 1, share.of_upper);
    }

    void add_block(std::size_t block, std::vector<double>& buses) const {
        const auto begin = static_cast<double>(block * kBlock);
        std::vector<audio::Orientation> orientations;
        for (std::size_t n = 0; n <= kBlock; n += kStretch) {
            orientations.push_back(sound_.orientation_at(time_of(begin + static_cast<double>(n))));
        }
        for (std::size_t path = 0; path < sound_.paths.paths().size(); ++path) {
            if (sound_.hrirs) {
                add_to_ears(path, begin, orientations, buses);
            } else {
                add_to_channels(path, begin, orientations, buses);
            }
        }
    }

    audio::MovingArrival arrival_of(const PathReception& reception,
                                    std::span<const double> gains) const {
        return {.delay = reception.delay, .delay_rate = reception.delay_rate, .gains = gains};
    }
    audio::MovingArrivalScale scale() const noexcept {
        return {.sample_rate = rate_, .speed_of_sound = sound_.speed_of_sound};
    }

    // Mono and ambisonics: a gain per channel.
    void add_to_channels(std::size_t path,
                         double begin,
                         std::span<const audio::Orientation> orientations,
                         std::vector<double>& buses) const {
        const MovingPath& moving = sound_.paths.paths()[path];
        const auto first = heard(moving, begin, begin + static_cast<double>(kBlock));
        if (!first) {
            return;
        }
        std::vector<double> weights(filters_.bank.filters()), harmonics(channels_, 1.0);
        const auto set_gains = [&](const PathReception& reception,
                                   const audio::Orientation& orientation,
                                   std::vector<double>& gains) {
            weigh(path, reception.emission, weights);
            if (channels_ > 1) {
                const audio::Arrival plane_wave = {.direction = direction_of(reception)};
                audio::spherical_harmonics(sound_.format.ambisonic_order,
                                           audio::origin_seen_from(orientation, plane_wave),
                                           harmonics);
            }
            for (std::size_t bus = 0; bus < gains.size(); ++bus) {
                gains[bus] = weights[bus / channels_] * harmonics[bus % channels_];
            }
        };
        std::array<std::vector<double>, 2> gains;
        gains.fill(std::vector<double>(weights.size() * channels_));
        PathReception from = *first;
        set_gains(from, orientations[0], gains[0]);
        for (std::size_t n = 0; n < kBlock; n += kStretch) {
            const double sample = begin + static_cast<double>(n);
            const PathReception to =
                receive(moving, sample + static_cast<double>(kStretch), from.emission);
            set_gains(to, orientations[n / kStretch + 1], gains[1]);
            audio::add_moving_arrival(scale(),
                                      recording_,
                                      sample,
                                      arrival_of(from, gains[0]),
                                      arrival_of(to, gains[1]),
                                      kStretch,
                                      kBlock,
                                      &buses[n]);
            from = to;
            std::swap(gains[0], gains[1]);
        }
    }

    static std::array<double, 3> direction_of(const PathReception& reception) {
        return {reception.arrival.x, reception.arrival.y, reception.arrival.z};
    }

    audio::InterpolatedHrir hrir_at(const MovingPath& path,
                                    double sample,
                                    const audio::Orientation& orientation,
                                    double near) const {
        const audio::Arrival plane_wave = {.direction = direction_of(receive(path, sample, near))};
        std::array<double, 3> towards = audio::origin_seen_from(orientation, plane_wave);
        if (towards == std::array<double, 3>{}) {
            towards = {1.0, 0.0, 0.0};
        }
        return sound_.hrirs->at(towards);
    }

    /// The path's sound before its filters, from sample `begin` on.
    std::vector<double> plain_sound(const MovingPath& path,
                                    double begin,
                                    std::size_t count,
                                    double near) const {
        const double one = 1.0;
        std::vector<double> samples((count + kStretch - 1) / kStretch * kStretch, 0.0);
        PathReception from = receive(path, begin, near);
        for (std::size_t n = 0; n < samples.size(); n += kStretch) {
            const double sample = begin + static_cast<double>(n);
            const PathReception to =
                receive(path, sample + static_cast<double>(kStretch), from.emission);
            audio::add_moving_arrival(scale(),
                                      recording_,
                                      sample,
                                      arrival_of(from, {&one, 1}),
                                      arrival_of(to, {&one, 1}),
                                      kStretch,
                                      kStretch,
                                      &samples[n]);
            from = to;
        }
        return samples;
    }

    // Two ears: the sound through the responses of its direction, cross-faded, then its filters.
    void add_to_ears(std::size_t path,
                     double begin,
                     std::span<const audio::Orientation> orientations,
                     std::vector<double>& buses) const {
        const MovingPath& moving = sound_.paths.paths()[path];
        constexpr auto kReach = static_cast<double>(2 * kHrirStretch);
        const auto first =
            heard(moving, begin - kReach, begin + static_cast<double>(kBlock) + kReach);
        if (!first) {
            return;
        }
        constexpr std::size_t kSteps = kBlock / kHrirStretch;
        std::vector<audio::InterpolatedHrir> hrirs;
        std::ptrdiff_t earliest = 0, latest = 0;
        for (std::size_t step = 0; step <= kSteps; ++step) {
            const std::size_t n = step * kHrirStretch;
            hrirs.push_back(hrir_at(moving,
                                    begin + static_cast<double>(n),
                                    orientations[n / kStretch],
                                    first->emission));
            const audio::InterpolatedHrir& hrir = hrirs.back();
            earliest = std::min(earliest, hrir.begin);
            latest =
                std::max(latest, hrir.begin + static_cast<std::ptrdiff_t>(hrir.ears[0].size()));
        }
        const auto before = static_cast<std::size_t>(latest);
        const auto after = static_cast<std::size_t>(-earliest);
        const std::vector<double> plain = plain_sound(
            moving, begin - static_cast<double>(before), before + kBlock + after, first->emission);
        // Sample n of the block is that of `plain` at n + before.
        std::array<std::vector<double>, 2> ears;
        ears.fill(std::vector<double>(kBlock, 0.0));
        for (std::size_t step = 0; step <= kSteps; ++step) {
            const std::size_t middle = step * kHrirStretch;
            const std::size_t low = step == 0 ? 0 : middle - kHrirStretch;
            const std::size_t high = std::min(middle + kHrirStretch, kBlock);
            for (std::size_t ear = 0; ear < 2; ++ear) {
                add_faded(plain, before, hrirs[step], ear, {low, middle, high}, ears[ear]);
            }
        }
        add_ears(path, begin, first->emission, ears, buses);
    }

    struct Fade {
        std::size_t low = 0, middle = 0, high = 0;  // silent, full, silent
    };

    static void add_faded(const std::vector<double>& plain,
                          std::size_t before,
                          const audio::InterpolatedHrir& hrir,
                          std::size_t ear,
                          const Fade& fade,
                          std::vector<double>& sum) {
        const std::vector<double>& taps = hrir.ears[ear];
        if (taps.empty() || fade.low == fade.high) {
            return;
        }
        // Sample n is the sum of taps[k] plain[n + before - begin - k].
        const std::size_t lead = taps.size() - 1;
        const auto begin =
            static_cast<std::size_t>(static_cast<std::ptrdiff_t>(fade.low + before) - hrir.begin) -
            lead;
        const std::vector<double> heard = audio::convolve_directly(
            std::span(plain).subspan(begin, fade.high - fade.low + lead), taps);
        for (std::size_t n = fade.low; n < fade.high; ++n) {
            const double away = n < fade.middle ? static_cast<double>(fade.middle - n)
                                                : static_cast<double>(n - fade.middle);
            sum[n] += (1.0 - away / static_cast<double>(kHrirStretch)) * heard[n - fade.low + lead];
        }
    }

    /// Weighs both ears into their buses.
    void add_ears(std::size_t path,
                  double begin,
                  double near,
                  const std::array<std::vector<double>, 2>& ears,
                  std::vector<double>& buses) const {
        const MovingPath& moving = sound_.paths.paths()[path];
        std::vector<double> from(filters_.bank.filters()), to(from.size());
        PathReception reception = receive(moving, begin, near);
        weigh(path, reception.emission, from);
        for (std::size_t n = 0; n < kBlock; n += kStretch) {
            reception =
                receive(moving, begin + static_cast<double>(n + kStretch), reception.emission);
            weigh(path, reception.emission, to);
            for (std::size_t filter = 0; filter < from.size(); ++filter) {
                const double step = (to[filter] - from[filter]) / static_cast<double>(kStretch);
                if (from[filter] == 0.0 && step == 0.0) {
                    continue;
                }
                for (std::size_t ear = 0; ear < 2; ++ear) {
                    double* bus = &buses[(filter * 2 + ear) * kBlock + n];
                    for (std::size_t k = 0; k < kStretch; ++k) {
                        bus[k] += (from[filter] + static_cast<double>(k) * step) * ears[ear][n + k];
                    }
                }
            }
            std::swap(from, to);
        }
    }

    const MovingEarlySound& sound_;
    std::span<const double> recording_;
    PathFilters filters_;
    std::size_t channels_;
    double rate_;
    std::size_t last_sample_ = 0;
};

}  // namespace

std::vector<std::vector<double>> render_early_sound(const MovingEarlySound& sound,
                                                    std::span<const double> recording,
                                                    Executor& executor,
                                                    Progress* progress) {
    return Rendering(sound, recording).render(executor, progress);
}

}  // namespace earshot::propagation
