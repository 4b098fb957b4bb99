// SPDX-License-Identifier: MIT
#include "support/path_table.h"

#include "support/rooms.h"
#include "support/test_paths.h"
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace earshot::support {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) {
        parts.push_back(part);
    }
    return parts;
}

}  // namespace

std::vector<TabledPath> read_path_table(const std::string& name) {
    const std::string file = test::source_file("tests/data/paths/").string() + name;
    std::ifstream stream(file);
    if (!stream) {
        throw std::runtime_error(file + ": cannot be read");
    }
    std::string line;
    std::getline(stream, line);  // the header
    std::vector<TabledPath> table;
    while (std::getline(stream, line)) {
        const std::vector<std::string> cells = split(line, ',');
        if (cells.size() != 9) {
            throw std::runtime_error(file + ": a line lacks nine columns");
        }
        TabledPath path;
        path.order = std::stoi(cells[0]);
        path.time = std::stod(cells[1]);
        path.length = std::stod(cells[2]);
        for (const std::string& wall : split(cells[5], '-')) {
            path.walls.push_back(static_cast<std::uint32_t>(std::stoul(wall)));
        }
        path.image = from_z_up(std::stod(cells[6]), std::stod(cells[7]), std::stod(cells[8]));
        table.push_back(path);
    }
    return table;
}

}  // namespace earshot::support
