// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/io/results.h"
#include "earshot/propagation/simulator.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::cli {

/// How listeners hear: the channels of their responses.
struct Listening {
    enum class Format { mono, binaural, ambisonic };
    Format format = Format::mono;
    int ambisonic_order = 1;
    audio::HeadResponses head{};  ///< for binaural, at the sample rate of the responses
};

/// The response of one listener to one source, the channels equally long, and its metrics.
struct HeardPair {
    std::vector<audio::ImpulseResponse> channels;
    io::PairMetrics metrics;
};

/// Early paths one by one and late sound as noise that takes the course of its energy. `length` as
/// in audio::ResponseOptions; the same seed gives the same noise.
HeardPair hear(const propagation::PairResult& pair,
               const propagation::Pose& listener,
               const Listening& listening,
               const audio::Bands& bands,
               const audio::Assembler& assembler,
               double length,
               std::uint64_t seed,
               Executor& executor);

}  // namespace earshot::cli
