// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_metric.h"

#include "earshot/base/error.h"
#include "earshot/base/spelling.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace earshot::propagation {
namespace {

constexpr std::string_view kSti = "sti";

std::optional<std::size_t> band_of(std::string_view text, const audio::Bands& bands) {
    double frequency_hz = 0.0;
    const auto [end, failure] =
        std::from_chars(text.data(), text.data() + text.size(), frequency_hz);
    if (failure != std::errc() || end != text.data() + text.size()) {
        return std::nullopt;
    }
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (bands.nominal_hz()[band] == frequency_hz) {
            return band;
        }
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::string> map_metric_keys() {
    std::vector<std::string> keys = {std::string(kSti)};
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        keys.emplace_back(kind.key);
    }
    return keys;
}

MapMetric::MapMetric(std::string_view text, const audio::Bands& bands) : name_(text) {
    const std::size_t colon = text.find(':');
    const std::string key(text.substr(0, colon));
    const auto kind = std::find_if(audio::kBandMetricKinds.begin(),
                                   audio::kBandMetricKinds.end(),
                                   [&](const auto& other) { return other.key == key; });
    if (kind != audio::kBandMetricKinds.end()) {
        kind_ = &*kind;
    } else if (key != kSti) {
        throw Error("metric " + key,
                    "there is none of that name",
                    did_you_mean(
                        key, map_metric_keys(), "give sti, edt, t20, t30, c50, c80, d50, ts or g"));
    }
    if (colon == std::string_view::npos) {
        return;
    }
    band_ = band_of(text.substr(colon + 1), bands);
    if (!band_ || kind_ == nullptr) {
        throw Error("metric " + name_,
                    kind_ == nullptr ? "STI has no bands" : "no band has that centre",
                    kind_ == nullptr ? "give sti" : "give a nominal centre in hertz, t30:125");
    }
}

double MapMetric::step() const noexcept {
    return kind_ != nullptr ? kind_->just_noticeable_difference
                            : audio::kSpeechJustNoticeableDifference;
}

double MapMetric::just_noticeable_difference(double value) const noexcept {
    return is_relative() ? step() * std::abs(value) : step();
}

bool MapMetric::larger_is_better() const noexcept {
    constexpr std::array<std::string_view, 4> kSmaller = {"edt", "t20", "t30", "ts"};
    return kind_ == nullptr ||
           std::find(kSmaller.begin(), kSmaller.end(), kind_->key) == kSmaller.end();
}

MapValue MapMetric::read(const audio::RoomMetrics& metrics) const {
    if (kind_ == nullptr) {
        return {.value = metrics.speech_transmission_index,
                .standard_error = metrics.standard_error.speech_transmission_index};
    }
    const auto of = [&](const audio::MetricValues& values) -> std::optional<double> {
        if (!band_) {
            return values.mid.*kind_->value;
        }
        return *band_ < values.bands.size() ? values.bands[*band_].*kind_->value : std::nullopt;
    };
    return {.value = of(metrics), .standard_error = of(metrics.standard_error)};
}

}  // namespace earshot::propagation
