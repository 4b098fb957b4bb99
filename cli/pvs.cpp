// SPDX-License-Identifier: MIT
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/pvs_report.h"
#include "earshot/cli/values.h"
#include "earshot/io/visibility_file.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

using geometry::TriangleId;
using visibility::VisibleSets;

constexpr const char* kFooter =
    "earshot pvs COMMAND --help describes a command.\n\n"
    "Examples:\n"
    "  earshot pvs build scenes/city.gltf --region 1,1,1:239,3,239 --cells 200 -o streets.pvs\n"
    "      what can be seen from each of 200 cells of the streets\n"
    "  earshot pvs show streets.pvs\n"
    "      which cells see the most, and what fewer would cost\n"
    "  earshot pvs extract streets.pvs --cost-ratio 1.2 -o fewer.pvs\n"
    "      as few cells as cost at most a fifth more than these, on average\n"
    "  earshot pvs query fewer.pvs --at 126,1.7,130 -o seen.csv\n"
    "      the triangles that can be seen from where this point is";

constexpr const char* kQueryFooter =
    "Example:\n"
    "  earshot pvs query streets.pvs --at 126,1.7,130 -o seen.csv\n"
    "      the triangles that can be seen from the cell of a point";

constexpr const char* kShowFooter =
    "Example:\n"
    "  earshot pvs show streets.pvs\n"
    "      which cells see the most, and what fewer would cost";

constexpr const char* kExtractFooter =
    "Example:\n"
    "  earshot pvs extract streets.pvs --memory 100000 -o small.pvs\n"
    "      as many cells as fit into 100 kB while sets are in use";

class PvsQueryCommand : public Command {
public:
    explicit PvsQueryCommand(CLI::App& group)
        : Command(group,
                  "query",
                  "Tell what is visible from the cell of a point",
                  {.threads = false, .simd = false}) {
        app().add_option("FILE", file_, "of earshot pvs build")->required();
        app().add_option("--at", at_option_, "X,Y,Z in metres")->required();
        add_output("-o,--output", output_, "a list of its triangles to write: .csv, or .json");
        app().footer(kQueryFooter);
    }

    void run() override {
        const auto at = parse_point(at_option_);
        if (!at) {
            throw wrong_usage(app(), "--at", "'" + at_option_ + "' is not of the form X,Y,Z");
        }
        const VisibleSets sets = io::read_visible_sets(file_);
        const auto cell = sets.cells().cell_at(*at);
        if (!cell) {
            throw Error("--at", at_option_ + " lies outside of the region", "see earshot pvs show");
        }
        const std::vector<TriangleId> triangles = sets.triangles_visible_from(*cell);
        if (!output_.empty()) {
            io::write_whole_file(output_, list_of(*cell, triangles));
        }
        if (common().json) {
            write_output(json_of(*cell, sets, triangles).dump(1) + "\n");
        } else if (!common().quiet) {
            write_output("cell       " + std::to_string(*cell) + "\nsees       " +
                         std::to_string(sets.sets()[*cell].size()) + " objects, " +
                         std::to_string(triangles.size()) + " triangles\n" +
                         (output_.empty() ? "" : "file       " + output_ + "\n"));
        }
    }

private:
    using Json = nlohmann::ordered_json;

    static Json json_of(visibility::CellId cell,
                        const VisibleSets& sets,
                        const std::vector<TriangleId>& triangles) {
        return {{"version", 1},
                {"cell", cell},
                {"volume", sets.cells().volumes()[cell]},
                {"objects", sets.sets()[cell].size()},
                {"triangles", triangles.size()}};
    }

    std::string list_of(visibility::CellId cell, const std::vector<TriangleId>& triangles) const {
        if (output_.ends_with(".json")) {
            return Json{{"version", 1}, {"cell", cell}, {"triangles", triangles}}.dump() + "\n";
        }
        std::string text = "triangle\n";
        for (const TriangleId triangle : triangles) {
            text += std::to_string(triangle) + "\n";
        }
        return text;
    }

    std::string file_, at_option_, output_;
};

class PvsShowCommand : public Command {
public:
    explicit PvsShowCommand(CLI::App& group)
        : Command(group,
                  "show",
                  "Report on a file: cells, sets, average cost of fewer cells",
                  {.threads = false, .simd = false}) {
        app().add_option("FILE", file_, "of earshot pvs build")->required();
        app().footer(kShowFooter);
    }

    void run() override {
        const VisibleSets sets = io::read_visible_sets(file_);
        if (common().json || !common().quiet) {
            write_output(pvs_summary(sets, file_, std::nullopt, common().json) +
                         (common().json ? "" : pvs_tables(sets)));
        }
    }

private:
    std::string file_;
};

class PvsExtractCommand : public Command {
public:
    explicit PvsExtractCommand(CLI::App& group)
        : Command(group,
                  "extract",
                  "Merge cells down to a given number, without sampling again",
                  {.threads = false, .simd = false}) {
        app().add_option("FILE", file_, "of earshot pvs build --cells or --grid")->required();
        add_output("-o,--output", output_, "the file to write")->required();
        CLI::Option* cells = add_integer(app(), "--cells", cells_, {1}, "so many, or as there are");
        CLI::Option* bytes = add_integer(
            app(), "--memory", bytes_, {1}, "as many as fit into this number of bytes at run time");
        CLI::Option* ratio = add_number(app(),
                                        "--cost-ratio",
                                        ratio_,
                                        {.min = 1.0},
                                        "as few as keep the average cost within this factor");
        cells->excludes(bytes)->excludes(ratio);
        bytes->excludes(ratio);
        app().footer(kExtractFooter);
    }

    void run() override {
        if (cells_ == 0 && bytes_ == 0 && ratio_ == 0.0) {
            throw wrong_usage(app(), "", "needs --cells, --memory or --cost-ratio");
        }
        const VisibleSets sets = io::read_visible_sets(file_);
        if (!sets.history()) {
            throw Error(file_, "its cells have no history", "make it with --cells or --grid");
        }
        const auto count =
            cells_ > 0 ? static_cast<std::size_t>(cells_)
            : bytes_ > 0
                ? sets.history()->cells_by_memory({.bytes = static_cast<std::uint64_t>(bytes_)})
                : sets.history()->cells_by_cost(ratio_);
        const VisibleSets fewer = sets.merged(count);
        io::write_visible_sets(output_, fewer);
        if (common().json || !common().quiet) {
            write_output(pvs_summary(fewer, output_, std::nullopt, common().json));
        }
    }

private:
    std::string file_, output_;
    std::int64_t cells_ = 0;
    std::int64_t bytes_ = 0;
    double ratio_ = 0.0;
};

}  // namespace

std::unique_ptr<Command> make_pvs_query_command(CLI::App& group) {
    return std::make_unique<PvsQueryCommand>(group);
}

std::unique_ptr<Command> make_pvs_show_command(CLI::App& group) {
    return std::make_unique<PvsShowCommand>(group);
}

std::unique_ptr<Command> make_pvs_extract_command(CLI::App& group) {
    return std::make_unique<PvsExtractCommand>(group);
}

std::unique_ptr<Command> make_pvs_command(CLI::App& program) {
    return std::make_unique<CommandGroup>(program,
                                          "pvs",
                                          "Visible sets from regions: build, query, show, extract",
                                          kFooter,
                                          CommandGroup::Makers{make_pvs_build_command,
                                                               make_pvs_query_command,
                                                               make_pvs_show_command,
                                                               make_pvs_extract_command});
}

}  // namespace earshot::cli
