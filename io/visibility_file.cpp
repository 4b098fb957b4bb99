// SPDX-License-Identifier: MIT
#include "earshot/io/visibility_file.h"

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/io/internal/bytes.h"
#include "earshot/io/whole_file.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace earshot::io {

using namespace visibility;
using geometry::Vec3;

namespace {

constexpr std::string_view kMagic = "earshotV";
constexpr std::uint64_t kVersion = 2;
constexpr std::uint64_t kVersionWithoutValidation = 1;  // still read
constexpr std::size_t kChecksumBytes = 8;

std::uint64_t checksum(std::string_view bytes) {
    Digest digest;
    digest.add_bytes(std::as_bytes(std::span(bytes)));
    return digest.value();
}

/// Numbers of cells, objects and groups.
std::uint32_t read_id(ByteReader& in) {
    const std::uint64_t id = in.leb128();
    if (id > std::numeric_limits<std::uint32_t>::max()) {
        in.fail("a number is too large");
    }
    return static_cast<std::uint32_t>(id);
}

void write_point(ByteWriter& out, const Vec3& point) {
    for (int axis = 0; axis < 3; ++axis) {
        out.number(point[axis]);
    }
}
Vec3 read_point(ByteReader& in) {
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = in.number();
    }
    return point;
}

void write_provenance(ByteWriter& out, const SetsProvenance& provenance) {
    out.string(provenance.scene);
    out.number(provenance.time);
    out.fixed(provenance.mesh_digest, 8);
    out.leb128(provenance.seed);
    out.leb128(provenance.rays);
    // No validation is one of no rays.
    const auto validation = provenance.validation.value_or(visibility::MissedShare{});
    out.leb128(validation.rays);
    out.leb128(validation.missed);
    out.number(validation.upper_bound());  // for other readers; here it follows from the two
}
SetsProvenance read_provenance(ByteReader& in, std::uint64_t version) {
    SetsProvenance provenance;
    provenance.scene = in.string();
    provenance.time = in.number();
    provenance.mesh_digest = in.fixed(8);
    provenance.seed = in.leb128();
    provenance.rays = in.leb128();
    if (version == kVersionWithoutValidation) {
        in.number();  // an estimate from the sampling itself, which said 0 where nothing was known
        return provenance;
    }
    const visibility::MissedShare validation = {.rays = in.leb128(), .missed = in.leb128()};
    if (validation.missed > validation.rays) {
        in.fail("more rays are missed than there are");
    }
    in.number();  // the upper bound
    if (validation.rays > 0) {
        provenance.validation = validation;
    }
    return provenance;
}

void write_cells(ByteWriter& out, const ViewCells& cells) {
    write_point(out, cells.region().lower);
    write_point(out, cells.region().upper);
    out.leb128(cells.leaves());
    for (const CellNode& node : cells.nodes()) {
        write_point(out, node.normal);
        out.number(node.offset);
        out.fixed(node.back, 4);
        out.fixed(node.front, 4);
    }
    for (std::size_t leaf = 0; leaf < cells.leaves(); ++leaf) {
        out.number(cells.leaf_volumes()[leaf]);
        out.leb128(cells.cell_of_leaf()[leaf]);
    }
}
ViewCells read_cells(ByteReader& in) {
    ViewRegion region;
    region.lower = read_point(in);
    region.upper = read_point(in);
    constexpr std::size_t kLeafBytes = 9;
    const std::size_t leaves = in.count(kLeafBytes);
    std::vector<CellNode> nodes(leaves > 0 ? leaves - 1 : 0);
    for (CellNode& node : nodes) {
        node.normal = read_point(in);
        node.offset = in.number();
        node.back = static_cast<std::uint32_t>(in.fixed(4));
        node.front = static_cast<std::uint32_t>(in.fixed(4));
    }
    std::vector<double> volumes(leaves);
    std::vector<CellId> cell_of_leaf(leaves);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
        volumes[leaf] = in.number();
        cell_of_leaf[leaf] = read_id(in);
    }
    return ViewCells(region, std::move(nodes), std::move(volumes)).merged(std::move(cell_of_leaf));
}

Objects read_objects(ByteReader& in) {
    std::vector<ObjectId> object_of_triangle(in.count(1));
    for (ObjectId& object : object_of_triangle) {
        object = read_id(in);
    }
    return Objects(std::move(object_of_triangle));
}

// Sets are ascending: the steps are small.
void write_set(ByteWriter& out, const std::vector<ObjectId>& set) {
    out.leb128(set.size());
    ObjectId next = 0;
    for (const ObjectId object : set) {
        out.leb128(object - next);
        next = object + 1;
    }
}
std::vector<ObjectId> read_set(ByteReader& in, std::size_t objects) {
    std::vector<ObjectId> set(in.count(1));
    std::uint64_t next = 0;
    for (ObjectId& object : set) {
        next += in.leb128();
        if (next >= objects) {
            in.fail("a set contains an object that does not exist");
        }
        object = static_cast<ObjectId>(next++);
    }
    return set;
}

void write_history(ByteWriter& out, const MergeHistory& history) {
    out.number(history.leaf_cost());
    for (const CellMerge& merge : history.merges()) {
        out.leb128(merge.first);
        out.leb128(merge.second);
        out.number(merge.cost);
        out.leb128(merge.entries);
    }
}
MergeHistory read_history(ByteReader& in, const std::vector<std::vector<ObjectId>>& sets) {
    const double leaf_cost = in.number();
    std::vector<std::uint64_t> leaf_entries;
    for (const std::vector<ObjectId>& set : sets) {
        leaf_entries.push_back(set.size());
    }
    std::vector<CellMerge> merges(sets.size() - 1);
    for (CellMerge& merge : merges) {
        merge.first = read_id(in);
        merge.second = read_id(in);
        merge.cost = in.number();
        merge.entries = in.leb128();
    }
    return {leaf_cost, std::move(leaf_entries), std::move(merges)};
}

VisibleSets read_body(ByteReader& in, std::uint64_t version) {
    SetsProvenance provenance = read_provenance(in, version);
    ViewCells cells = read_cells(in);
    Objects objects = read_objects(in);
    std::vector<std::vector<ObjectId>> sets(cells.size());
    for (std::vector<ObjectId>& set : sets) {
        set = read_set(in, objects.size());
    }
    std::optional<MergeHistory> history;
    if (in.fixed(1) != 0) {
        history = read_history(in, sets);
    }
    if (in.remaining() > 0) {
        in.fail("it has data past its end");
    }
    return {std::move(cells),
            std::move(objects),
            std::move(sets),
            std::move(provenance),
            std::move(history)};
}

}  // namespace

void write_visible_sets(const std::filesystem::path& file, const VisibleSets& sets) {
    ByteWriter out;
    out.raw(kMagic);
    out.fixed(kVersion, 4);
    write_provenance(out, sets.provenance());
    write_cells(out, sets.cells());
    const auto object_of_triangle = sets.objects().object_of_triangle();
    out.leb128(object_of_triangle.size());
    for (const ObjectId object : object_of_triangle) {
        out.leb128(object);
    }
    for (const std::vector<ObjectId>& set : sets.sets()) {
        write_set(out, set);
    }
    out.fixed(sets.history() ? 1 : 0, 1);
    if (sets.history()) {
        write_history(out, *sets.history());
    }
    out.fixed(checksum(out.bytes()), kChecksumBytes);
    write_whole_file(file, out.bytes());
}

VisibleSets read_visible_sets(const std::filesystem::path& file) {
    const std::string bytes = read_whole_file(file);
    const std::string name = file.string();
    if (!bytes.starts_with(kMagic)) {
        throw Error(name, "is not a file of visible sets", "make one with earshot pvs build");
    }
    ByteReader head(bytes, name);
    head.raw(kMagic.size());
    const std::uint64_t version = head.fixed(4);
    if (version != kVersion && version != kVersionWithoutValidation) {
        throw Error(name,
                    "has version " + std::to_string(version) + ", and " +
                        std::to_string(kVersionWithoutValidation) + " to " +
                        std::to_string(kVersion) + " are known",
                    "make it anew");
    }
    const std::size_t head_bytes = bytes.size() - head.remaining();
    if (head.remaining() < kChecksumBytes) {
        head.fail("it is truncated");
    }
    const std::string_view checked(bytes.data(), bytes.size() - kChecksumBytes);
    ByteReader tail(std::string_view(bytes).substr(checked.size()), name);
    if (tail.fixed(kChecksumBytes) != checksum(checked)) {
        throw Error(
            name, "its checksum does not fit", "the file is damaged or truncated; create it again");
    }
    ByteReader body(checked, name);
    body.raw(head_bytes);
    try {
        return read_body(body, version);
    } catch (const Error& error) {
        // What does not fit together inside of a file is the file's fault.
        throw error.subject() == name ? error
                                      : Error(name,
                                              error.subject() + ": " + error.what(),
                                              "the file is damaged; create it again");
    }
}

}  // namespace earshot::io
