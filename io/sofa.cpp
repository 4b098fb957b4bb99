// SPDX-License-Identifier: MIT
#include "earshot/io/sofa.h"

#include "earshot/base/error.h"

#include <mysofa.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

namespace earshot::io {

namespace {

struct FreeSofa {
    void operator()(MYSOFA_HRTF* sofa) const noexcept { mysofa_free(sofa); }
};
using SofaHandle = std::unique_ptr<MYSOFA_HRTF, FreeSofa>;

std::span<const float> values_of(const MYSOFA_ARRAY& array) {
    return {array.values, array.values == nullptr ? 0 : array.elements};
}

SofaHandle open(const std::filesystem::path& file) {
    int fault = MYSOFA_OK;
    SofaHandle sofa(mysofa_load(file.c_str(), &fault));
    if (!sofa || fault != MYSOFA_OK) {
        throw Error(file.string(), "cannot be read as a SOFA file", "give a SOFA file of AES69");
    }
    if (mysofa_check(sofa.get()) != MYSOFA_OK) {
        throw Error(file.string(),
                    "contains no head-related impulse responses of two ears",
                    "use a file of the convention SimpleFreeFieldHRIR");
    }
    const auto delays = values_of(sofa->DataDelay);
    if (std::any_of(delays.begin(), delays.end(), [](float d) { return d != 0.0F; })) {
        throw Error(file.string(),
                    "stores delays separately from the responses",
                    "export it with the delays in the responses");
    }
    return sofa;
}

}  // namespace

audio::HrirSet read_hrir_set(const std::filesystem::path& file) {
    const SofaHandle sofa = open(file);
    mysofa_tocartesian(sofa.get());
    const auto positions = values_of(sofa->SourcePosition);
    const auto samples = values_of(sofa->DataIR);
    const auto rates = values_of(sofa->DataSamplingRate);
    const std::size_t taps = sofa->N;
    const auto is_finite = [](float value) { return std::isfinite(value); };
    if (sofa->M == 0 || taps == 0 || rates.empty() || !(rates[0] > 0.0F) || !is_finite(rates[0]) ||
        positions.size() != std::size_t{sofa->M} * 3 ||
        samples.size() != std::size_t{sofa->M} * 2 * taps ||
        !std::all_of(samples.begin(), samples.end(), is_finite)) {
        throw Error(file.string(), "its responses are incomplete or not finite", "export it again");
    }
    audio::HrirSet head;
    head.sample_rate = rates[0];
    for (std::size_t i = 0; i < sofa->M; ++i) {
        const double x = positions[3 * i];
        const double y = positions[3 * i + 1];
        const double z = positions[3 * i + 2];
        const double distance = std::sqrt(x * x + y * y + z * z);
        if (!(distance > 0.0 && std::isfinite(distance))) {
            throw Error(file.string(),
                        "a source position is inside the head or not finite",
                        "export it again");
        }
        const auto left = samples.subspan(2 * i * taps, taps);
        const auto right = samples.subspan((2 * i + 1) * taps, taps);
        head.directions.push_back({.towards = {x / distance, y / distance, z / distance},
                                   .left{left.begin(), left.end()},
                                   .right{right.begin(), right.end()}});
    }
    return head;
}

}  // namespace earshot::io
