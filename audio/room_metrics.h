// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/speech.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::audio {

/// ISO 3382-1 metrics of one band. A value the response cannot support is empty: a decay time where
/// the decay ends too early or is shorter than the band's filter rings, the others where the
/// response ends before their limit (docs/algorithms/audio.md).
struct BandMetrics {
    std::optional<double> early_decay_time;        ///< EDT, seconds
    std::optional<double> reverberation_time_t20;  ///< T20, seconds
    std::optional<double> reverberation_time_t30;  ///< T30, seconds
    std::optional<double> clarity_c50_db;          ///< C50
    std::optional<double> clarity_c80_db;          ///< C80
    std::optional<double> definition_d50;          ///< D50, 0..1
    std::optional<double> centre_time;             ///< Ts, seconds
    std::optional<double> strength_db;             ///< G, re free field at 10 m
};

struct RoomMetrics {
    std::vector<BandMetrics> bands;                   ///< one per band, in order
    std::optional<double> speech_transmission_index;  ///< STI, see speech.h
    std::vector<std::string> notes;  ///< why a value is empty, e.g. "t20 at 63 Hz: decay range ..."
};

struct MetricsOptions {
    /// The response was measured: it ends in steady noise, which is estimated and taken out (ISO
    /// 3382-1:2009, 5.3.3; Lundeby et al. 1995). Decay times that the noise does not leave room
    /// for, 10 dB below their range, are empty.
    bool ends_in_noise = false;
    /// The response is known to hold the whole decay: it is not looked for signs that it was cut
    /// off.
    bool full_decay = false;
    /// For the speech transmission index.
    std::optional<SpeechLevels> speech{};
};

/// Metrics per band by zero-phase octave or third-octave filters, the onset of the direct sound
/// (20 dB below the largest sample) and backward integration (ISO 3382-1:2009, 5.3.3 and annex A).
/// Ts counts from the onset; G takes a pressure of 1 as free field at 1 m. Every value that is
/// empty is explained in the notes; a silent response has none and one note.
RoomMetrics room_metrics(const Bands& bands,
                         const ImpulseResponse& response,
                         const MetricsOptions& options = {});

/// The same metrics of the energies that arrive, on a grid of a tenth of a millisecond: what a
/// response has on average over small changes of place, without the interference of its arrivals,
/// the chance of its noise and the ringing of filters, as programs of geometrical room acoustics
/// give them. The onset is the first energy less than 20 dB below the largest of an instant in its
/// band. STI only for octaves.
RoomMetrics energy_metrics(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late);

/// Frequency above which the room's modes overlap and sound follows rays (Schroeder and Kuttruff
/// 1962): 2000 sqrt(time / volume), hertz, of the mean T30 (or T20, else EDT) of the octaves or
/// thirds from 400 Hz to 1250 Hz; nothing if there is none. Precondition: volume > 0, cubic metres.
std::optional<double> schroeder_frequency_hz(const Bands& bands,
                                             const RoomMetrics& metrics,
                                             double volume);

/// The single number of a metric: the mean of the octaves 500 Hz and 1 kHz, or of the thirds from
/// 400 Hz to 1250 Hz (ISO 3382-1:2009, table A.1); empty if one of them is.
std::optional<double> mid_frequency_mean(const Bands& bands,
                                         const RoomMetrics& metrics,
                                         std::optional<double> BandMetrics::*value);

}  // namespace earshot::audio
