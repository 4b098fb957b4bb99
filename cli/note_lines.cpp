// SPDX-License-Identifier: MIT
#include "earshot/cli/note_lines.h"

#include "earshot/cli/formatted.h"

#include <algorithm>

namespace earshot::cli {
namespace {

/// Notes that differ in their bands, or in their metrics, alone.
struct Group {
    std::vector<std::string> metrics;
    std::vector<double> bands_hz;
    std::string text;
};

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : ", ") + word;
    }
    return text;
}

std::string frequencies(const std::vector<double>& bands_hz) {
    std::vector<std::string> words;
    for (const double frequency_hz : bands_hz) {
        words.push_back(formatted("%g", frequency_hz));
    }
    return joined(words) + " Hz";
}

std::vector<Group> groups_over_bands(const std::vector<audio::MetricNote>& notes) {
    std::vector<Group> groups;
    for (const audio::MetricNote& note : notes) {
        auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
            return g.metrics.front() == note.metric && g.text == note.text &&
                   g.bands_hz.empty() == !note.band_hz;
        });
        if (group == groups.end()) {
            groups.push_back({{note.metric}, {}, note.text});
            group = groups.end() - 1;
        }
        if (note.band_hz) {
            group->bands_hz.push_back(*note.band_hz);
        }
    }
    return groups;
}

}  // namespace

std::vector<std::string> note_lines(const std::vector<audio::MetricNote>& notes) {
    std::vector<Group> groups;
    for (const Group& of_metric : groups_over_bands(notes)) {
        const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
            return g.text == of_metric.text && g.bands_hz == of_metric.bands_hz;
        });
        if (same == groups.end()) {
            groups.push_back(of_metric);
        } else {
            same->metrics.push_back(of_metric.metrics.front());
        }
    }
    std::vector<std::string> lines;
    for (const Group& group : groups) {
        lines.push_back(joined(group.metrics) +
                        (group.bands_hz.empty() ? "" : " at " + frequencies(group.bands_hz)) +
                        ": " + group.text);
    }
    return lines;
}

}  // namespace earshot::cli
