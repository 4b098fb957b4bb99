// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/propagation/pose.h"
#include "earshot/propagation/response.h"

#include <string>
#include <vector>

namespace earshot::io {

/// A response between one source and one listener.
struct RoomMeasurement {
    propagation::Pose source, listener;
    std::vector<audio::ImpulseResponse> channels;
};

/// The bytes of a SOFA file (AES69-2022, a netCDF-4 file): convention SingleRoomSRIR, a measurement
/// per response and a receiver per channel, 64-bit samples, shorter responses filled up with zeros.
/// `kind` places the receivers: at the listener, at the ears, or as spherical harmonics. SOFA's
/// axes have z up: x, -z, y of ours. Carries no date, so the same responses give the same bytes.
/// Throws Error if the file cannot be made. Precondition: at least one measurement, all of one
/// sample rate and as many channels, 2 of them for ears, (order + 1)^2 for spherical harmonics.
std::string encode_room_responses(const std::string& title,
                                  propagation::Channels kind,
                                  const std::vector<RoomMeasurement>& measurements);

}  // namespace earshot::io
