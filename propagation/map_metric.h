// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/room_metrics.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::propagation {

/// A value and its standard error; either may be unknown.
struct MapValue {
    std::optional<double> value{};
    std::optional<double> standard_error{};
};

/// A metric that is mapped: of one band, or its single number (the mean over 500 Hz and 1 kHz, or
/// the speech transmission index).
class MapMetric {
public:
    /// `text`: "sti", the key of a kBandMetricKinds ("t30"), or a key and the nominal centre of a
    /// band in hertz ("t30:125"). Throws Error naming the metric if there is none of that name.
    MapMetric(std::string_view text, const audio::Bands& bands);

    /// As it was given: "t30", "t30:125".
    const std::string& name() const noexcept { return name_; }
    /// "s", "dB" or empty.
    std::string_view unit() const noexcept { return kind_ != nullptr ? kind_->unit : ""; }
    /// Just-noticeable difference at a value, in the metric's unit.
    double just_noticeable_difference(double value) const noexcept;
    /// Whether the just-noticeable difference is a share of the value.
    bool is_relative() const noexcept { return kind_ != nullptr && kind_->relative; }
    /// A share if it is relative, else in the metric's unit.
    double step() const noexcept;
    /// Whether larger values are the better ones for speech and clarity: of STI, C50, C80, D50 and
    /// G. Of decay times and the centre time smaller ones are.
    bool larger_is_better() const noexcept;

    MapValue read(const audio::RoomMetrics& metrics) const;

private:
    std::string name_;
    const audio::BandMetricKind* kind_ = nullptr;  // null: STI
    std::optional<std::size_t> band_;
};

/// Every key, STI first.
std::vector<std::string> map_metric_keys();

}  // namespace earshot::propagation
