// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/ccd.h"

#include "earshot/base/parallel.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/collision/narrow_phase/min_separation.h"
#include "earshot/io/contact_queries.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

using collision::MovingPoints;
using collision::RationalPoints;

constexpr const char* kFooter =
    "A query has eight lines, each with numerator,denominator of x, y and z: four points at the\n"
    "beginning of the step, then at its end. The points are a vertex and the corners of a face, "
    "or\n"
    "the ends of two edges. A seventh value, 0 or 1, is the true result if it is known. OUT.csv "
    "has\n"
    "a line `hit,toi` per query; the time of impact in 0..1 is never later than the true one.\n\n"
    "Examples:\n"
    "  earshot ccd queries.csv --kind vertex-face -o times.csv\n"
    "  earshot ccd queries.csv --kind edge-edge --min-separation 1e-3 -o times.csv --json";

struct Answer {
    std::optional<double> time;
    double microseconds = 0.0;
};

/// The fewest digits that read back as the same double.
std::string digits(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

class CcdCommand : public Command {
public:
    explicit CcdCommand(CLI::App& program)
        : Command(program,
                  "ccd",
                  "Decide elementary queries of continuous collision detection",
                  {.simd = false}) {
        app().add_option("QUERIES", queries_file_, "a .csv file of queries")->required();
        app()
            .add_option("--kind", kind_, "vertex-face or edge-edge")
            ->check(CLI::IsMember({"vertex-face", "edge-edge"}))
            ->required();
        add_output("-o,--output", output_, "the .csv file to write")->required();
        add_number(app(),
                   "--min-separation",
                   separation_.min_separation,
                   {0.0, 1e100},
                   "points this close along every axis are in contact; 0: exact contact");
        add_number(app(),
                   "--tolerance",
                   separation_.tolerance,
                   {1e-300, 1e100},
                   "how much farther apart may count as closer, with --min-separation");
        app().footer(kFooter);
    }

    void run() override {
        const auto queries = io::read_contact_queries(queries_file_);
        Executor executor(static_cast<int>(common().threads));
        std::vector<Answer> answers(queries.size());
        executor.for_each(queries.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                answers[i] = answer(queries[i].points);
            }
        });
        std::string text;
        for (const Answer& answer : answers) {
            text += answer.time ? "1," + digits(*answer.time) + "\n" : "0,\n";
        }
        io::write_whole_file(output_, text);
        if (common().json || !common().quiet) {
            write_output(summary(queries, answers));
        }
    }

private:
    Answer answer(const RationalPoints& points) const {
        const auto doubles = collision::as_doubles(points);
        if (!doubles && separation_.min_separation > 0.0) {
            throw Error(
                queries_file_, "has coordinates that are not doubles", "omit --min-separation");
        }
        const auto start = std::chrono::steady_clock::now();
        Answer answer;
        answer.time = doubles ? time_of(*doubles) : time_of(points);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        answer.microseconds = 1e6 * elapsed.count();
        return answer;
    }

    std::optional<double> time_of(const MovingPoints& points) const {
        const bool is_face = kind_ == "vertex-face";
        if (separation_.min_separation > 0.0) {
            return is_face ? collision::vertex_face_min_separation_ccd(points, separation_)
                           : collision::edge_edge_min_separation_ccd(points, separation_);
        }
        return is_face ? collision::vertex_face_ccd(points) : collision::edge_edge_ccd(points);
    }

    std::optional<double> time_of(const RationalPoints& points) const {
        return kind_ == "vertex-face" ? collision::vertex_face_ccd(points)
                                      : collision::edge_edge_ccd(points);
    }

    std::string summary(const std::vector<io::ContactQuery>& queries,
                        const std::vector<Answer>& answers) const {
        std::size_t hits = 0, with_truth = 0, false_positives = 0, false_negatives = 0;
        double sum = 0.0;
        std::vector<double> times;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool hit = answers[i].time.has_value();
            hits += hit ? 1 : 0;
            if (const auto& truth = queries[i].truth) {
                ++with_truth;
                false_positives += hit && !*truth ? 1 : 0;
                false_negatives += !hit && *truth ? 1 : 0;
            }
            times.push_back(answers[i].microseconds);
            sum += answers[i].microseconds;
        }
        std::sort(times.begin(), times.end());
        const double mean = times.empty() ? 0.0 : sum / static_cast<double>(times.size());
        const double median = times.empty() ? 0.0 : times[times.size() / 2];
        if (common().json) {
            nlohmann::ordered_json json = {
                {"version", 1},
                {"file", std::filesystem::path(queries_file_).filename()},
                {"kind", kind_},
                {"queries", queries.size()},
                {"hits", hits}};
            if (with_truth > 0) {
                json["with_truth"] = with_truth;
                json["false_positives"] = false_positives;
                json["false_negatives"] = false_negatives;
            }
            json["microseconds"] = {{"mean", mean}, {"median", median}};
            return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        }
        std::string text = "queries    " + std::to_string(queries.size()) + ", " +
                           std::to_string(hits) + " with a contact\n";
        if (with_truth > 0) {
            text += "truth      " + std::to_string(false_positives) + " false positives, " +
                    std::to_string(false_negatives) + " false negatives of " +
                    std::to_string(with_truth) + "\n";
        }
        return text + formatted("time       mean %.2f us, median %.2f us\n", mean, median) +
               "file       " + output_ + "\n";
    }

    std::string queries_file_, kind_, output_;
    collision::MinSeparationOptions separation_;
};

}  // namespace

std::unique_ptr<Command> make_ccd_command(CLI::App& program) {
    return std::make_unique<CcdCommand>(program);
}

}  // namespace earshot::cli
