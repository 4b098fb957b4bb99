// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace earshot::audio {

/// The values of a signal between its samples: values[n] is that at positions[n], which is at least
/// kDelayHalfLength - 1 and leaves kDelayHalfLength samples behind it. `rows`: DelayTable::rows().
void read_between(const double* signal,
                  const double* rows,
                  const double* positions,
                  std::size_t count,
                  double* values);

/// sum[n] += (gain + n * step) * values[n].
void add_ramp(const double* values, std::size_t count, double gain, double step, double* sum);

}  // namespace earshot::audio
