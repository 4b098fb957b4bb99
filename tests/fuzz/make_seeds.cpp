// SPDX-License-Identifier: MIT
// earshot_fuzz_seeds FOLDER: writes the seeds that no text editor writes into FOLDER/READER.
#include "earshot/io/internal/sofa_file.h"
#include "earshot/io/visibility_file.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"
#include "earshot/visibility/merge_cells.h"

#include "fuzz/gltf_seeds.h"
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <map>
#include <utility>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, std::string_view bytes) {
    fs::create_directories(file.parent_path());
    io::write_whole_file(file, bytes);
}

void write_scenes(const fs::path& folder) {
    for (const GltfSeed& seed : gltf_seeds()) {
        write(folder / "glb" / (seed.name + ".glb"), seed.builder.glb());
        write(folder / "gltf" / (seed.name + ".gltf"), seed.builder.gltf());
    }
}

template <typename T>
std::string packed(T value, bool is_big_endian = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return is_big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

void write_binary_meshes(const fs::path& folder) {
    std::string stl = std::string(80, ' ') + packed<std::uint32_t>(2);
    for (const float z : {0.0F, 1.0F}) {
        for (const float number : {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, z, 1.0F, 0.0F, z, 0.0F, 1.0F, z}) {
            stl += packed(number);
        }
        stl += packed<std::uint16_t>(0);
    }
    write(folder / "stl/binary.stl", stl);
    for (const bool is_big : {false, true}) {
        const std::string order = is_big ? "big" : "little";
        std::string ply = "ply\nformat binary_" + order +
                          "_endian 1.0\ncomment units: mm\nelement vertex 4\nproperty float x\n"
                          "property double y\nproperty short z\nelement face 2\nproperty uchar "
                          "flags\nproperty list uchar int vertex_indices\nend_header\n";
        for (const int corner : {0, 1, 2, 3}) {
            ply += packed(static_cast<float>(corner & 1), is_big) +
                   packed(corner >= 2 ? 1.0 : 0.0, is_big) +
                   packed(static_cast<std::int16_t>(corner), is_big);
        }
        for (const std::vector<std::int32_t>& face :
             {std::vector{0, 1, 2}, std::vector{0, 1, 3, 2}}) {
            ply += '\7' + std::string(1, static_cast<char>(face.size()));
            for (const std::int32_t corner : face) {
                ply += packed(corner, is_big);
            }
        }
        write(folder / ("ply/binary-" + order + ".ply"), ply);
    }
}

/// A WAV file of 16-bit integers, with a chunk that readers skip.
std::string plain_wav() {
    const std::string samples("\1\0\2\0\xFF\x7F\0\x80", 8);
    const std::string chunks = "WAVEfmt " + packed<std::uint32_t>(16) + packed<std::uint16_t>(1) +
                               packed<std::uint16_t>(2) + packed<std::uint32_t>(44100) +
                               packed<std::uint32_t>(176400) + packed<std::uint16_t>(4) +
                               packed<std::uint16_t>(16) + "note" + packed<std::uint32_t>(4) +
                               "text" + "data" + packed<std::uint32_t>(8) + samples;
    return "RIFF" + packed(static_cast<std::uint32_t>(chunks.size())) + chunks;
}

void write_sounds(const fs::path& folder) {
    write(folder / "wav/float.wav", io::encode_wav({48000.0, 1, {0.0, 0.5, -1.0, 0.25}}));
    write(folder / "wav/four-channels.wav",
          io::encode_wav({8000.0, 4, std::vector<double>(16, 0.125)}));
    write(folder / "wav/integers.wav", plain_wav());
}

/// What is read of a file of three directions or, as emitters, of two.
void write_sofa_replies(const fs::path& folder) {
    const std::map<std::string, std::string> cartesian = {{"Type", "cartesian"},
                                                          {"Units", "metre"}};
    const std::map<std::string, std::string> spherical = {{"Type", "spherical"},
                                                          {"Units", "degree, degree, metre"}};
    io::SofaFile plain;
    plain.attributes = {
        {"Conventions", "SOFA"}, {"DataType", "FIR"}, {"SOFAConventions", "SimpleFreeFieldHRIR"}};
    plain.variables = {
        {"Data.IR",
         {{3, 2, 4},
          {0, 1, 0, .5, 0, .5, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, .5, 1, 0, 0, 0},
          {}}},
        {"Data.SamplingRate", {{3}, {48000, 44100, 48000}, {{"Units", "hertz"}}}},
        {"Data.Delay", {{1, 2}, {0, 1.5}, {}}},
        {"SourcePosition", {{3, 3}, {0, 0, 1, 90, 0, 1, 0, 90, 2}, spherical}},
        {"ListenerPosition", {{1, 3}, {0, 0, 0}, cartesian}},
        {"ListenerView", {{1, 3}, {1, 0, 0}, cartesian}},
        {"ListenerUp", {{1, 3}, {0, 0, 1}, {}}},
        {"ReceiverPosition", {{2, 3, 1}, {0, .09, 0, 0, -.09, 0}, cartesian}}};
    io::SofaFile emitters = plain;
    emitters.attributes["DataType"] = "FIR-E";
    emitters.attributes["SOFAConventions"] = "FreeFieldHRIR";
    emitters.variables["Data.IR"] = {{1, 2, 3, 2}, {1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0}, {}};
    emitters.variables["Data.SamplingRate"] = {{1}, {44100}, {}};
    emitters.variables["Data.Delay"] = {{1, 2, 2}, {0, 1, 2, 3}, {}};
    emitters.variables["SourcePosition"] = {{1, 3}, {0, 0, 0}, cartesian};
    emitters.variables["SourceView"] = {{1, 3}, {0, 1, 0}, cartesian};
    emitters.variables["SourceUp"] = {{1, 3}, {0, 0, 1}, {}};
    emitters.variables["EmitterPosition"] = {{2, 3, 1}, {1, 0, 0, 0, 1, 1}, cartesian};
    for (const auto& [name, sofa] :
         {std::pair{"plain", &plain}, std::pair{"emitters", &emitters}}) {
        std::string bytes;
        io::send_sofa_reply(*sofa, [&](std::string_view part) { bytes += part; });
        write(folder / "sofa_reply" / (std::string(name) + ".bin"), bytes);
    }
}

void write_visible_sets(const fs::path& folder) {
    fs::create_directories(folder / "visible_sets");
    const auto cells = visibility::ViewCells::grid({{-1.0, 0.5, 2.0}, {3.0, 4.0, 8.0}}, {2, 2, 1});
    const visibility::Objects objects(std::vector<visibility::ObjectId>{0, 1, 2, 0, 1, 2, 3});
    const std::vector<std::vector<visibility::ObjectId>> sets{{0, 2}, {}, {0, 1, 2, 3}, {1}};
    const visibility::SetsProvenance provenance{
        .scene = "made",
        .time = 1.5,
        .mesh_digest = 0xfedcba9876543210ULL,
        .seed = 7,
        .rays = 123'456'789'012ULL,
        .validation = visibility::MissedShare{.rays = 65536, .missed = 7}};
    io::write_visible_sets(folder / "visible_sets/plain.pvs", {cells, objects, sets, provenance});
    const std::vector<double> costs(objects.size(), 2.0);
    io::write_visible_sets(
        folder / "visible_sets/history.pvs",
        {cells, objects, sets, provenance, visibility::merge_cells(cells, sets, costs)});
}

}  // namespace
}  // namespace earshot::test

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: earshot_fuzz_seeds FOLDER\n", stderr);
        return 2;
    }
    try {
        earshot::test::write_scenes(argv[1]);
        earshot::test::write_binary_meshes(argv[1]);
        earshot::test::write_sounds(argv[1]);
        earshot::test::write_sofa_replies(argv[1]);
        earshot::test::write_visible_sets(argv[1]);
    } catch (const std::exception& fault) {
        std::fprintf(stderr, "earshot_fuzz_seeds: %s\n", fault.what());
        return 1;
    }
    return 0;
}
