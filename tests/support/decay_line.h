// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace earshot::support {

/// Seconds for 60 dB of the straight line, by least squares, through the levels of what remains of
/// an energy, `step` seconds apart, from `from_db` to `to_db` below the first.
inline double line_time(std::span<const double> remaining,
                        double step,
                        double from_db,
                        double to_db) {
    double count = 0.0, t = 0.0, l = 0.0, tt = 0.0, tl = 0.0;
    for (std::size_t n = 0; n < remaining.size(); ++n) {
        const double level = 10.0 * std::log10(remaining[n] / remaining.front());
        if (level <= -from_db && level >= -to_db) {
            const double time = static_cast<double>(n) * step;
            count += 1.0;
            t += time;
            l += level;
            tt += time * time;
            tl += time * level;
        }
    }
    return -60.0 * (count * tt - t * t) / (count * tl - t * l);
}

}  // namespace earshot::support
