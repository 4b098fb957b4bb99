// SPDX-License-Identifier: MIT
#include "earshot/io/internal/hrir_set.h"

#include "earshot/audio/delay.h"
#include "earshot/base/error.h"
#include "earshot/io/internal/sofa_coordinates.h"
#include "earshot/io/internal/text.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

namespace earshot::io {

namespace {

using geometry::Vec3;

constexpr std::array kConventions = {
    "SimpleFreeFieldHRIR", "FreeFieldHRIR", "GeneralFIR", "GeneralFIR-E", "GeneralFIRE"};
constexpr const char* kSmaller = "use a smaller set";
constexpr const char* kRemedy = "use a file of the convention SimpleFreeFieldHRIR";

// netCDF's value of what was never written is 9.97e36.
constexpr double kMaxSample = 1e30;
constexpr double kMinSampleRate = 1e3;  // hertz, as of responses
constexpr double kMaxSampleRate = 768e3;
// Of one response that has to be resampled: a filter is made for every sample.
constexpr double kMaxResampledLength = 1U << 18U;
constexpr double kMaxDelay = 1.0;            // seconds that may stand beside a response
constexpr double kMinSourceDistance = 1e-3;  // metres
constexpr std::size_t kMaxDirections = std::size_t{1} << 20U;
// Ears that lie less far to the left and right of each other than this are not told apart, metres.
constexpr double kMinEarDistance = 1e-3;

// The samples of a file and how they are numbered.
struct Responses {
    const std::vector<double>* samples = nullptr;
    std::size_t measurements = 0;
    std::size_t receivers = 0;
    std::size_t length = 0;
    std::size_t emitters = 1;
    bool is_emitter_last = false;  ///< M R N E; else M R E N

    std::vector<double> of(std::size_t m, std::size_t r, std::size_t e) const {
        std::vector<double> response(length);
        const std::size_t first =
            (m * receivers + r) * length * emitters + (is_emitter_last ? e : e * length);
        const std::size_t step = is_emitter_last ? emitters : 1;
        for (std::size_t n = 0; n < length; ++n) {
            response[n] = (*samples)[first + n * step];
        }
        return response;
    }
};

class SetReader {
public:
    SetReader(const SofaFile& sofa, const std::string& file) : sofa_(sofa), file_(file) {}

    audio::HrirSet read() {
        check_kind();
        read_responses();
        read_sample_rates();
        read_delays();
        check_size();
        audio::HrirSet set;
        set.sample_rate = *std::max_element(rates_.begin(), rates_.end());
        add_measurements(set);
        raise_sample_rates(set);
        return set;
    }

private:
    [[noreturn]] void fail(const std::string& what,
                           const std::string& remedy = "export the file again") const {
        throw Error(file_, what, remedy);
    }

    const SofaVariable& variable(const char* name) const {
        const SofaVariable* found = sofa_.find(name);
        if (found == nullptr) {
            fail(std::string("has no ") + name);
        }
        return *found;
    }

    void check_kind() const {
        if (sofa_.attribute("Conventions") != "SOFA") {
            fail("is an HDF5 file but no SOFA file: its attribute Conventions is not SOFA",
                 "give a SOFA file (AES69)");
        }
        const std::string type = sofa_.attribute("DataType");
        const std::string convention = sofa_.attribute("SOFAConventions");
        if (type != "FIR" && type != "FIR-E" && type != "FIRE") {
            fail(type.empty() ? "has no DataType"
                              : "holds data of the type " + shortened(type) +
                                    ", not impulse responses (FIR)",
                 kRemedy);
        }
        if (std::find(kConventions.begin(), kConventions.end(), convention) == kConventions.end()) {
            fail(convention.empty()
                     ? "does not say its SOFAConventions"
                     : "is of the convention " + shortened(convention) +
                           ", which is not of head-related impulse responses in a free field",
                 kRemedy);
        }
    }

    void read_responses() {
        const SofaVariable& data = variable("Data.IR");
        const bool has_emitters = sofa_.attribute("DataType") != "FIR";
        const std::vector<std::size_t>& shape = data.shape;
        if (shape.size() != (has_emitters ? 4U : 3U)) {
            fail("Data.IR does not have the dimensions that AES69 gives it");
        }
        responses_.samples = &data.values;
        responses_.measurements = shape[0];
        responses_.receivers = shape[1];
        // GeneralFIRE of AES69-2015 is M R E N, the data type FIR-E since 2020 M R N E.
        responses_.is_emitter_last = sofa_.attribute("DataType") == "FIR-E";
        responses_.length = shape[!has_emitters || responses_.is_emitter_last ? 2 : 3];
        responses_.emitters = !has_emitters ? 1 : shape[responses_.is_emitter_last ? 3 : 2];
        if (responses_.receivers != 2) {
            fail("has responses of " + std::to_string(responses_.receivers) +
                     (responses_.receivers == 1 ? " receiver" : " receivers") + ", not of two ears",
                 kRemedy);
        }
        if (data.values.empty()) {
            fail("its Data.IR is empty");
        }
        if (!std::all_of(data.values.begin(), data.values.end(), [](double sample) {
                return std::abs(sample) <= kMaxSample;
            })) {
            fail("its responses are incomplete or not finite");
        }
    }

    void read_sample_rates() {
        const SofaVariable& data = variable("Data.SamplingRate");
        const auto units = data.attributes.find("Units");
        if (units != data.attributes.end() && lower_case(units->second) != "hertz" &&
            lower_case(units->second) != "hz") {
            fail("Data.SamplingRate has the Units \"" + shortened(units->second) + "\"",
                 "AES69 has hertz");
        }
        if (data.values.size() != 1 && data.values.size() != responses_.measurements) {
            fail("Data.SamplingRate does not have the dimensions that AES69 gives it");
        }
        for (std::size_t m = 0; m < responses_.measurements; ++m) {
            const double rate = data.values[data.values.size() == 1 ? 0 : m];
            if (!(rate >= kMinSampleRate && rate <= kMaxSampleRate)) {
                fail("its sample rate is not between 1 kHz and 768 kHz");
            }
            rates_.push_back(rate);
        }
    }

    // I R or M R, with emitters I R I, M R I, I R E or M R E.
    void read_delays() {
        delays_ = sofa_.find("Data.Delay");
        if (delays_ == nullptr) {
            return;
        }
        const std::vector<std::size_t>& shape = delays_->shape;
        const auto is_one_or = [](std::size_t size, std::size_t all) {
            return size == 1 || size == all;
        };
        if ((shape.size() != 2 && shape.size() != 3) ||
            !is_one_or(shape[0], responses_.measurements) || !is_one_or(shape[1], 2) ||
            (shape.size() == 3 && !is_one_or(shape[2], responses_.emitters))) {
            fail("Data.Delay does not have the dimensions that AES69 gives it");
        }
        const double max = kMaxDelay * *std::min_element(rates_.begin(), rates_.end());
        for (const double delay : delays_->values) {
            if (!(delay >= 0.0 && delay <= max)) {
                fail("Data.Delay is not between 0 and 1 s everywhere (it counts samples)");
            }
        }
    }

    // A small file may ask for long delays or to be resampled to a rate that is many times higher.
    void check_size() const {
        if (responses_.measurements > kMaxDirections / responses_.emitters) {
            fail("has more than " + std::to_string(kMaxDirections) + " directions", kSmaller);
        }
        double length = static_cast<double>(responses_.length);
        if (delays_ != nullptr) {
            length += *std::max_element(delays_->values.begin(), delays_->values.end());
        }
        const double highest = *std::max_element(rates_.begin(), rates_.end());
        double samples = 0.0;
        for (const double rate : rates_) {
            const double resampled_length = length * (highest / rate);
            if (rate < highest && resampled_length > kMaxResampledLength) {
                fail("has sample rates that differ and responses too long to resample",
                     "export it at one sample rate");
            }
            samples += 2.0 * static_cast<double>(responses_.emitters) * resampled_length;
        }
        if (!(samples <= static_cast<double>(kMaxSofaValues))) {
            fail("comes to more than " + std::to_string(kMaxSofaValues) +
                     " samples with its delays and at its highest sample rate",
                 kSmaller);
        }
    }

    double delay(std::size_t m, std::size_t r, std::size_t e) const {
        if (delays_ == nullptr) {
            return 0.0;
        }
        const std::vector<std::size_t>& shape = delays_->shape;
        const std::size_t emitters = shape.size() == 3 ? shape[2] : 1;
        const std::size_t row = (shape[0] == 1 ? 0 : m) * shape[1] + (shape[1] == 1 ? 0 : r);
        return delays_->values[row * emitters + (emitters == 1 ? 0 : e)];
    }

    // `type`: where the variable itself gives none.
    SofaCoordinates coordinates(const char* name,
                                const std::string& type,
                                SofaLayout layout,
                                std::size_t objects,
                                std::optional<Vec3> instead) const {
        const SofaVariable* found = sofa_.find(name);
        if (found == nullptr && instead) {
            return SofaCoordinates(*instead);
        }
        return {file_, name, variable(name), type, layout, objects, responses_.measurements};
    }

    // Axes of the listener or the source: up is of the type of view.
    struct Orientations {
        SofaCoordinates view, up;
    };
    Orientations orientations(const std::string& object) const {
        const std::string view = object + "View";
        const SofaVariable* found = sofa_.find(view);
        std::string type = "cartesian";
        if (found != nullptr && found->attributes.count("Type") > 0) {
            type = found->attributes.at("Type");
        }
        constexpr auto kLayout = SofaLayout::per_measurement;
        return {coordinates(view.c_str(), type, kLayout, 1, Vec3{1.0, 0.0, 0.0}),
                coordinates((object + "Up").c_str(), type, kLayout, 1, Vec3{0.0, 0.0, 1.0})};
    }

    // Where in the listener's axes the left ear is: as receiver 0 or 1.
    std::size_t left_receiver(const SofaCoordinates& receivers, std::size_t m) const {
        const double first = receivers.at(0, m).y;
        const double second = receivers.at(1, m).y;
        if (!(std::abs(first - second) > kMinEarDistance)) {
            fail("ReceiverPosition does not say which receiver is the left ear",
                 "give the ears their places, +0.09 m and -0.09 m to the left");
        }
        return first > second ? 0 : 1;
    }

    audio::Hrir measurement(const Vec3& source, std::size_t left, std::size_t m, std::size_t e) {
        const double distance = std::sqrt(glm::dot(source, source));
        if (!(distance >= kMinSourceDistance && std::isfinite(distance))) {
            fail("measurement " + std::to_string(m + 1) + " has its source where the listener is");
        }
        audio::Hrir hrir;
        hrir.towards = {source.x / distance, source.y / distance, source.z / distance};
        hrir.distance = distance;
        hrir.left = audio::delayed(responses_.of(m, left, e), delay(m, left, e));
        hrir.right = audio::delayed(responses_.of(m, 1 - left, e), delay(m, 1 - left, e));
        const std::size_t size = std::max(hrir.left.size(), hrir.right.size());
        hrir.left.resize(size);
        hrir.right.resize(size);
        return hrir;
    }

    void add_measurements(audio::HrirSet& set) {
        constexpr Vec3 kOrigin{0.0};
        constexpr auto kSingle = SofaLayout::per_measurement;
        constexpr auto kMany = SofaLayout::per_object;
        const SofaCoordinates sources = coordinates("SourcePosition", "", kSingle, 1, {});
        const SofaCoordinates emitters =
            coordinates("EmitterPosition", "cartesian", kMany, responses_.emitters, kOrigin);
        const SofaCoordinates listeners =
            coordinates("ListenerPosition", "cartesian", kSingle, 1, kOrigin);
        const SofaCoordinates receivers = coordinates("ReceiverPosition", "", kMany, 2, {});
        const Orientations source_axes = orientations("Source");
        const Orientations listener_axes = orientations("Listener");
        for (std::size_t m = 0; m < responses_.measurements; ++m) {
            const SofaAxes source =
                sofa_axes(file_, "Source", source_axes.view.at(0, m), source_axes.up.at(0, m));
            const SofaAxes listener = sofa_axes(
                file_, "Listener", listener_axes.view.at(0, m), listener_axes.up.at(0, m));
            const std::size_t left = left_receiver(receivers, m);
            for (std::size_t e = 0; e < responses_.emitters; ++e) {
                const Vec3 place = sources.at(0, m) + source.out_of(emitters.at(e, m));
                set.directions.push_back(
                    measurement(listener.into(place - listeners.at(0, m)), left, m, e));
            }
        }
    }

    // Measurements of a lower sample rate than the highest, resampled rate by rate.
    void raise_sample_rates(audio::HrirSet& set) const {
        std::vector<double> rates = rates_;
        std::sort(rates.begin(), rates.end());
        rates.erase(std::unique(rates.begin(), rates.end()), rates.end());
        rates.pop_back();
        for (const double rate : rates) {
            audio::HrirSet part;
            part.sample_rate = rate;
            std::vector<std::size_t> places;
            for (std::size_t i = 0; i < set.directions.size(); ++i) {
                if (rates_[i / responses_.emitters] == rate) {
                    places.push_back(i);
                    part.directions.push_back(std::move(set.directions[i]));
                }
            }
            part = audio::resampled(part, set.sample_rate);
            for (std::size_t i = 0; i < places.size(); ++i) {
                set.directions[places[i]] = std::move(part.directions[i]);
            }
        }
    }

    const SofaFile& sofa_;
    const std::string& file_;
    Responses responses_;
    std::vector<double> rates_;  ///< of each measurement, hertz
    const SofaVariable* delays_ = nullptr;
};

}  // namespace

audio::HrirSet hrir_set_of(const SofaFile& sofa, const std::string& file) {
    return SetReader(sofa, file).read();
}

}  // namespace earshot::io
