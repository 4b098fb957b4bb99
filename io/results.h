// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/pose.h"
#include "earshot/propagation/scene.h"

#include <span>
#include <string>
#include <vector>

namespace earshot::io {

/// What paths.json and histograms.json say about the run as a whole.
struct ResultHeader {
    const propagation::Scene& scene;
    const audio::Bands& bands;
    double speed_of_sound = 0.0;  ///< metres per second
};

/// The text of paths.json: one path per line, numbers with the fewest digits that read back as the
/// same double. `listeners`: how the listener of each pair is turned, or nothing, and the text
/// does not tell. Precondition: none, or as many as pairs.
std::string encode_paths(const ResultHeader& header,
                         const std::vector<propagation::PairResult>& pairs,
                         std::span<const propagation::Pose> listeners = {});

/// The text of histograms.json: the late energy of each pair and its standard errors, band by band.
std::string encode_histograms(const ResultHeader& header,
                              const std::vector<propagation::PairResult>& pairs);

/// The bytes of the WAV file of a response, as encode_wav(). Precondition: there is a channel, and
/// all have one sample rate and size.
std::string encode_response(const std::vector<audio::ImpulseResponse>& channels);

}  // namespace earshot::io
