// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_interpolator.h"
#include "earshot/audio/hrir_set.h"
#include "earshot/audio/spatial.h"

#include <array>
#include <span>

namespace earshot::audio {

/// The responses of both ears, left first, equally long: every arrival through the HRIRs of its
/// direction. Arrivals without a direction are taken from the front. `length` as in
/// ResponseOptions. Throws Error as Assembler::assemble. Precondition: the assembler has the sample
/// rate of the HRIRs.
std::array<ImpulseResponse, 2> render_binaural(const Assembler& assembler,
                                               std::span<const Arrival> arrivals,
                                               const HrirInterpolator& hrirs,
                                               const Orientation& orientation = {},
                                               double length = 0.0,
                                               Executor& executor = Executor::serial());

}  // namespace earshot::audio
