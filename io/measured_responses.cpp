// SPDX-License-Identifier: MIT
#include "earshot/io/measured_responses.h"

#include "earshot/audio/response_metrics.h"
#include "earshot/io/result_names.h"
#include "earshot/io/wav.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <system_error>
#include <utility>

namespace earshot::io {

namespace {

namespace fs = std::filesystem;
using propagation::MeasuredMetric;

constexpr std::array<const char*, 5> kSoundSuffixes = {".wav", ".flac", ".ogg", ".aiff", ".aif"};

bool is_sound_file(const fs::path& file) {
    return std::find(kSoundSuffixes.begin(), kSoundSuffixes.end(), file.extension().string()) !=
           kSoundSuffixes.end();
}

/// Sound files of a folder by name without suffix, in the order of names.
std::multimap<std::string, fs::path> sound_files(const fs::path& folder) {
    std::multimap<std::string, fs::path> files;
    std::vector<fs::path> sorted;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
        if (is_sound_file(entry->path())) {
            sorted.push_back(entry->path());
        }
    }
    if (failure) {
        throw Error(folder.string(), "cannot be read: " + failure.message(), "check the folder");
    }
    std::sort(sorted.begin(), sorted.end());
    for (fs::path& file : sorted) {
        files.emplace(file.stem().string(), std::move(file));
    }
    return files;
}

audio::ImpulseResponse first_channel(const Sound& sound) {
    audio::ImpulseResponse response{.sample_rate = sound.sample_rate, .samples = {}};
    for (std::size_t i = 0; i < sound.samples.size();
         i += static_cast<std::size_t>(sound.channels)) {
        response.samples.push_back(sound.samples[i]);
    }
    return response;
}

class FolderReader {
public:
    FolderReader(const propagation::Scene& scene, const MeasuredResponseOptions& options)
        : scene_(scene), options_(options), missing_(options.kinds.size(), 0) {}

    MeasuredMetrics read(const fs::path& folder) {
        auto files = sound_files(folder);
        const ResultNames names(scene_);
        std::size_t pairs = 0;
        for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
            for (std::size_t listener = 0; listener < scene_.listeners.size(); ++listener) {
                const std::string& name = names.of(source, listener);
                const auto [first, last] = files.equal_range(name);
                if (first == last) {
                    continue;
                }
                if (std::next(first) != last) {
                    throw Error(folder.string(),
                                "holds several recordings named " + name,
                                "keep one of them");
                }
                read_recording(first->second, source, listener);
                files.erase(name);
                ++pairs;
            }
        }
        if (pairs == 0) {
            throw Error(
                folder.string(), "holds no recording of a pair of the scene", names_remedy(names));
        }
        for (const auto& [name, file] : files) {
            result_.warnings.push_back({file.string(), "is of no pair of the scene; left out"});
        }
        warn_of_missing(folder.string(), pairs);
        return std::move(result_);
    }

private:
    std::string names_remedy(const ResultNames& names) const {
        return scene_.sources.empty() || scene_.listeners.empty()
                   ? "give the scene sources and listeners"
                   : "name them SOURCE__LISTENER.wav, as in " + names.of(0, 0) + ".wav";
    }

    void read_recording(const fs::path& file, std::size_t source, std::size_t listener) {
        const audio::ImpulseResponse recording = first_channel(read_sound(file));
        audio::RoomMetrics metrics;
        if (options_.noise_free) {
            metrics = audio::response_metrics(
                options_.bands, recording, {.onset = audio::direct_sound(recording)});
            audio::calibrate_strength(options_.bands, options_.strength_correction_db, metrics);
        } else {
            const audio::MeasuredMetrics measured = audio::measured_metrics(
                options_.bands,
                recording,
                {.strength_correction_db = options_.strength_correction_db});
            metrics = measured.metrics;
            if (measured.part && measured.part->clipping.samples > 0) {
                result_.warnings.push_back({file.string(),
                                            std::to_string(measured.part->clipping.samples) +
                                                " samples are clipped; record with less gain"});
            }
        }
        for (std::size_t k = 0; k < options_.kinds.size(); ++k) {
            for (std::size_t band = 0; band < metrics.bands.size(); ++band) {
                const auto value =
                    metrics.bands[band].*audio::kBandMetricKinds[options_.kinds[k]].value;
                if (!value) {
                    ++missing_[k];
                    continue;
                }
                result_.values.push_back({.source = source,
                                          .listener = listener,
                                          .kind = options_.kinds[k],
                                          .band = band,
                                          .value = *value});
            }
        }
    }

    void warn_of_missing(const std::string& folder, std::size_t pairs) {
        for (std::size_t k = 0; k < missing_.size(); ++k) {
            if (missing_[k] > 0) {
                result_.warnings.push_back(
                    {folder,
                     std::to_string(missing_[k]) + " of " +
                         std::to_string(pairs * options_.bands.count()) + " values of " +
                         std::string(audio::kBandMetricKinds[options_.kinds[k]].key) +
                         " are not supported by the recordings (too much noise or too short); "
                         "earshot metrics tells why"});
            }
        }
    }

    const propagation::Scene& scene_;
    const MeasuredResponseOptions& options_;
    std::vector<std::size_t> missing_;  // per kind
    MeasuredMetrics result_;
};

}  // namespace

MeasuredMetrics read_measured_responses(const fs::path& folder,
                                        const propagation::Scene& scene,
                                        const MeasuredResponseOptions& options) {
    MeasuredMetrics result = FolderReader(scene, options).read(folder);
    if (result.values.empty()) {
        throw Error(folder.string(),
                    "holds recordings that support none of the metrics",
                    "earshot metrics tells why");
    }
    return result;
}

MeasuredMetrics read_measured(const fs::path& folder_or_table,
                              const propagation::Scene& scene,
                              const MeasuredResponseOptions& options,
                              bool has_kinds) {
    std::error_code failure;
    if (fs::is_directory(folder_or_table, failure)) {
        return read_measured_responses(folder_or_table, scene, options);
    }
    return read_measured_table(
        folder_or_table,
        scene,
        options.bands,
        has_kinds ? std::span<const std::size_t>(options.kinds) : std::span<const std::size_t>());
}

}  // namespace earshot::io
