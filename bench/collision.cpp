// SPDX-License-Identifier: MIT
//
// bench_collision FOLDER: time per elementary query of continuous collision detection, one thread,
// over all files of queries below the folder, and how many answers differ from the truth.

#include "earshot/base/error.h"
#include "earshot/collision/narrow_phase/ccd.h"
#include "earshot/io/contact_queries.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace {

using earshot::collision::MovingPoints;

struct Query {
    MovingPoints points;
    bool truth = false;
};

std::vector<Query> read_all(const std::filesystem::path& folder, const std::string& kind) {
    std::vector<Query> queries;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".csv" ||
            entry.path().parent_path().filename().string() != kind) {
            continue;
        }
        for (const auto& query : earshot::io::read_contact_queries(entry.path())) {
            if (const auto points = earshot::collision::as_doubles(query.points)) {
                queries.push_back({*points, query.truth.value_or(false)});
            }
        }
    }
    return queries;
}

void measure(const std::filesystem::path& folder, const std::string& kind) {
    const bool is_face = kind == "vertex-face";
    const std::vector<Query> queries = read_all(folder, kind);
    std::vector<double> times(queries.size(), std::numeric_limits<double>::infinity());
    std::size_t wrong = 0, hits = 0;
    for (int repeat = 0; repeat < 5; ++repeat) {
        wrong = hits = 0;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            bool hit = false;
            const double seconds = bench::seconds_of([&] {
                hit = is_face ? earshot::collision::vertex_face_ccd(queries[i].points).has_value()
                              : earshot::collision::edge_edge_ccd(queries[i].points).has_value();
            });
            times[i] = std::min(times[i], 1e6 * seconds);
            hits += hit ? 1 : 0;
            wrong += hit != queries[i].truth ? 1 : 0;
        }
    }
    if (times.empty()) {
        return;
    }
    std::sort(times.begin(), times.end());
    double sum = 0.0;
    for (const double time : times) {
        sum += time;
    }
    std::printf("| %s | %zu | %zu | %zu | %.2f | %.3f | %.2f | %.1f | %.0f |\n",
                kind.c_str(),
                times.size(),
                hits,
                wrong,
                sum / static_cast<double>(times.size()),
                times[times.size() / 2],
                times[times.size() * 9 / 10],
                times[times.size() * 99 / 100],
                times.back());
}

int run(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: bench_collision FOLDER\n");
        return 2;
    }
    std::printf(
        "| queries | count | contacts | wrong | mean us | median us | 90 %% | 99 %% | "
        "worst |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    measure(argv[1], "vertex-face");
    measure(argv[1], "edge-edge");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_collision", argc, argv, run);
}
