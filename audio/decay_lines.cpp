// SPDX-License-Identifier: MIT
#include "earshot/audio/decay_lines.h"

#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/energy_course.h"
#include "earshot/base/assert.h"

namespace earshot::audio {
namespace {

std::vector<double> levels_of(const DecayCurve& curve, const DecayLineOptions& options) {
    std::vector<double> levels;
    for (std::size_t k = 0;; ++k) {
        const double energy = curve.energy_from(static_cast<double>(k) * options.step);
        const std::optional<double> level = curve.level_db(energy);
        if (!level || *level < options.min_level_db) {
            return levels;
        }
        levels.push_back(*level);
    }
}

}  // namespace

std::vector<BandDecayLines> decay_lines(const Bands& bands,
                                        std::span<const Arrival> arrivals,
                                        const EnergyHistogram& late,
                                        const DecayLineOptions& options) {
    EARSHOT_ASSERT(options.step > 0.0 && options.min_level_db < 0.0);
    std::vector<BandDecayLines> lines(bands.count());
    if (arrivals.empty() && late.energy.empty()) {
        return lines;
    }
    const EnergyCourse course = energy_course(bands, arrivals, late);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const std::vector<double>& energy = course.energy[band];
        if (!(energy[course.onset[band]] > 0.0)) {
            continue;
        }
        const DecayCurve curve(energy, course.onset[band], course.sample_rate);
        lines[band] = {.level_db = levels_of(curve, options),
                       .edt = curve.line(kEarlyDecay),
                       .t20 = curve.line(kT20),
                       .t30 = curve.line(kT30)};
    }
    return lines;
}

}  // namespace earshot::audio
