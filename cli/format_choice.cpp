// SPDX-License-Identifier: MIT
#include "earshot/cli/format_choice.h"

#include "earshot/audio/spatial.h"
#include "earshot/cli/values.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/io/sofa.h"

#include <string_view>

namespace earshot::cli {
namespace {

/// A set of the user's is equalised already, if its author meant it to be, but its responses begin
/// at an instant of their own.
audio::HrirSet hrir_set(const std::string& file, bool raw) {
    if (file.empty() && !raw) {
        return io::default_hrir_set();
    }
    audio::HrirSet set = io::read_hrir_set(file.empty() ? io::kDefaultHrirSet : file);
    if (!raw) {
        set.centre_delay = audio::common_delay(set);
    }
    return set;
}

}  // namespace

void FormatChoice::add_to(CLI::App& app) {
    app.add_option("--format",
                   format_,
                   "channels of a response: mono, binaural or ambisonic:N (order N up to 5, "
                   "ACN, SN3D)")
        ->capture_default_str();
    app.add_option("--hrtf",
                   hrtf_file_,
                   "HRIR set for binaural responses, a SOFA file; default: a KEMAR manikin, "
                   "diffuse-field equalised")
        ->type_name("FILE");
    app.add_flag("--hrtf-raw",
                 raw_hrtf_,
                 "use the HRIR set as it was measured: without equalisation, and with the "
                 "delay that all of its responses have in common");
}

void FormatChoice::apply(const CLI::App& app, propagation::ResponseFormat& format) const {
    using propagation::Channels;
    constexpr std::string_view kAmbisonic = "ambisonic:";
    if (format_ == "binaural") {
        format.channels = Channels::binaural;
        format.hrir_set = hrir_set(hrtf_file_, raw_hrtf_);
    } else if (format_.starts_with(kAmbisonic)) {
        const auto order = parse_integer_within(
            std::string_view(format_).substr(kAmbisonic.size()), 0, audio::kMaxAmbisonicOrder);
        if (!order) {
            throw wrong_usage(app, "--format", "the order of '" + format_ + "' is not in 0 ... 5");
        }
        format.channels = Channels::ambisonic;
        format.ambisonic_order = static_cast<int>(*order);
    } else if (!is_mono()) {
        throw wrong_usage(
            app, "--format", "'" + format_ + "' is not one of mono, binaural, ambisonic:N");
    }
}

}  // namespace earshot::cli
