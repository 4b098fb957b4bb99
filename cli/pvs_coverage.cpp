// SPDX-License-Identifier: MIT
#include "earshot/cli/pvs_coverage.h"

#include <algorithm>
#include <cstddef>

namespace earshot::cli {

Warnings uncovered_sources(const propagation::Scene& scene,
                           const visibility::VisibleSets& sets,
                           const std::string& sets_file,
                           std::span<const double> instants) {
    Warnings warnings;
    for (const propagation::Emitter& source : scene.sources) {
        const auto outside = static_cast<std::size_t>(
            std::count_if(instants.begin(), instants.end(), [&](double instant) {
                return !sets.cells().region().contains(scene.position_at(source, instant));
            }));
        if (outside == 0) {
            continue;
        }
        const std::string when = outside == instants.size()
                                     ? ""
                                     : " at " + std::to_string(outside) + " of " +
                                           std::to_string(instants.size()) + " instants";
        warnings.push_back({sets_file,
                            "source \"" + source.name +
                                "\" lies outside of the region of the sets" + when +
                                ", so that none of its paths are left out there; see " +
                                "earshot pvs show, and --region of earshot pvs build"});
    }
    return warnings;
}

}  // namespace earshot::cli
