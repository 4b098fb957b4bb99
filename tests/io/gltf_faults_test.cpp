// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/gltf_builder.h"
#include "support/temporary_folder.h"
#include <functional>
#include <utility>

namespace earshot::io {
namespace {

using test::GltfBuilder;
using Json = nlohmann::json;

/// A file that uses everything, so that a fault anywhere matters: a skinned, morphed, animated
/// triangle. Accessors: 0 positions, 1 indices, 2 displacements, 3 joints, 4 weights, 5 inverse
/// bind matrices, 6 key times, 7 translations, 8 morph weights, 9 rotations.
GltfBuilder everything() {
    GltfBuilder b = test::one_triangle();
    const int up = b.add_accessor<float>("VEC3", {0, 0, 0, 0, 2, 0, 0, 0, 0});
    b.primitive(0)["targets"] = Json::array({{{"POSITION", up}}});
    const std::vector<std::uint8_t> joints(12, 0);
    b.primitive(0)["attributes"]["JOINTS_0"] = b.add_accessor("VEC4", joints);
    b.primitive(0)["attributes"]["WEIGHTS_0"] =
        b.add_accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    b.primitive(0)["material"] = 0;
    b.add_node({{"name", "joint"}, {"rotation", {0, 0, 0, 1}}});
    const int bind =
        b.add_accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    b.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", bind}}};
    b.json["nodes"][0]["skin"] = 0;
    const int times = b.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int slide = b.add_accessor<float>("VEC3", {0, 0, 0, 4, 0, 0});
    const int weights = b.add_accessor<float>("SCALAR", {0, 1});
    const int turns = b.add_accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, 1, 0});
    b.json["animations"] = Json::array();
    b.add_animation(1, "translation", times, slide, "LINEAR");
    Json& animation = b.json["animations"][0];
    animation["samplers"].push_back({{"input", times}, {"output", weights}});
    animation["samplers"].push_back({{"input", times}, {"output", turns}});
    animation["channels"].push_back(
        {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
    animation["channels"].push_back(
        {{"sampler", 2}, {"target", {{"node", 1}, {"path", "rotation"}}}});
    b.json["materials"] = {{{"name", "brick-painted"}}};
    b.json["scenes"] = {{{"nodes", {0, 1}}}};
    b.json["buffers"] = {{{"byteLength", b.bytes.size()}}};
    return b;
}

struct Fault {
    const char* what;      ///< for the reader of a failure
    const char* expected;  ///< must be part of the error line
    std::function<void(GltfBuilder&)> make;
};

void put_float(GltfBuilder& b, std::size_t accessor, std::size_t number, float value) {
    const auto view = b.json["accessors"][accessor]["bufferView"].get<std::size_t>();
    const auto offset = b.json["bufferViews"][view]["byteOffset"].get<std::size_t>();
    std::memcpy(b.bytes.data() + offset + 4 * number, &value, 4);
}

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

const std::vector<Fault>& faults() {
    static const std::vector<Fault> kFaults{
        {"no asset", "no glTF asset", [](auto& b) { b.json.erase("asset"); }},
        {"no version", "version is missing", [](auto& b) { b.json["asset"] = Json::object(); }},
        {"glTF 1", "version 1.0", [](auto& b) { b.json["asset"]["version"] = "1.0"; }},
        {"version a number", "not a text", [](auto& b) { b.json["asset"]["version"] = 2; }},
        {"an array", "not a glTF object", [](auto& b) { b.json = Json::array(); }},
        {"an extension that is not read",
         "requires the extension KHR_gaussian_splatting",
         [](auto& b) { b.json["extensionsRequired"] = {"KHR_gaussian_splatting"}; }},
        {"extensions no array",
         "extensionsUsed is not an array",
         [](auto& b) { b.json["extensionsUsed"] = "KHR_mesh_quantization"; }},
        {"nodes no array", "nodes is not an array", [](auto& b) { b.json["nodes"] = 3; }},
        {"node no object",
         "node 2: it is not a JSON object",
         [](auto& b) { b.json["nodes"].push_back(7); }},
        {"buffer without length",
         "buffer 0: byteLength is missing",
         [](auto& b) { b.json["buffers"][0].erase("byteLength"); }},
        {"2 GB buffer",
         "buffer 0: byteLength claims 2147483648 bytes",
         [](auto& b) { b.json["buffers"][0]["byteLength"] = 2147483648U; }},
        {"16 EB buffer",
         "buffer 0: byteLength claims 18446744073709551615 bytes",
         [](auto& b) { b.json["buffers"][0]["byteLength"] = ~std::uint64_t{0}; }},
        {"negative buffer",
         "buffer 0: byteLength is not a whole number",
         [](auto& b) { b.json["buffers"][0]["byteLength"] = -5; }},
        {"missing bin",
         "walls.bin is missing",
         [](auto& b) { b.json["buffers"][0]["uri"] = "walls.bin"; }},
        {"remote bin",
         "https://example.org/walls.bin is not a file",
         [](auto& b) { b.json["buffers"][0]["uri"] = "https://example.org/walls.bin"; }},
        {"broken base64",
         "base64",
         [](auto& b) { b.json["buffers"][0]["uri"] = "data:;base64,!!!!"; }},
        {"data URI of text",
         "not base64",
         [](auto& b) { b.json["buffers"][0]["uri"] = "data:text/plain,hello"; }},
        {"second buffer without uri",
         "buffer 1: it has no uri",
         [](auto& b) {
             b.json["buffers"].push_back({{"byteLength", 4}});
             b.json["bufferViews"][0]["buffer"] = 1;
         }},
        {"view of no buffer",
         "bufferView 0: buffer: index 7 is not below 1",
         [](auto& b) { b.json["bufferViews"][0]["buffer"] = 7; }},
        {"view past its buffer",
         "bufferView 0: its 36 bytes from 1000000",
         [](auto& b) { b.json["bufferViews"][0]["byteOffset"] = 1000000; }},
        {"view offset that overflows",
         "bufferView 0",
         [](auto& b) { b.json["bufferViews"][0]["byteOffset"] = ~std::uint64_t{0} - 3; }},
        {"view length too long",
         "bufferView 0: its 4294967296 bytes",
         [](auto& b) { b.json["bufferViews"][0]["byteLength"] = 4294967296U; }},
        {"stride too small",
         "byteStride is smaller than an element of accessor 0",
         [](auto& b) { b.json["bufferViews"][0]["byteStride"] = 4; }},
        {"stride not of four",
         "byteStride",
         [](auto& b) { b.json["bufferViews"][0]["byteStride"] = 13; }},
        {"accessor count too large",
         "accessor 0: its 4 elements do not lie in bufferView 0",
         [](auto& b) { b.json["accessors"][0]["count"] = 4; }},
        {"accessor count that overflows",
         "accessor 0: its 18446744073709551615 elements",
         [](auto& b) { b.json["accessors"][0]["count"] = ~std::uint64_t{0}; }},
        {"accessor count negative",
         "accessor 0: count is not a whole number",
         [](auto& b) { b.json["accessors"][0]["count"] = -3; }},
        {"accessor count a fraction",
         "accessor 0: count is not a whole number",
         [](auto& b) { b.json["accessors"][0]["count"] = 2.5; }},
        {"accessor offset that overflows",
         "accessor 0: its 3 elements",
         [](auto& b) { b.json["accessors"][0]["byteOffset"] = ~std::uint64_t{0} - 7; }},
        {"accessor of no view",
         "accessor 0: bufferView: index 99 is not below",
         [](auto& b) { b.json["accessors"][0]["bufferView"] = 99; }},
        {"accessor view negative",
         "accessor 0: bufferView is not an index",
         [](auto& b) { b.json["accessors"][0]["bufferView"] = -1; }},
        {"view index beyond 32 bits",
         "accessor 0: bufferView: index 4294967296",
         [](auto& b) { b.json["accessors"][0]["bufferView"] = 4294967296U; }},
        {"huge accessor without bytes",
         "accessor 0: it claims 1000000000000 elements without a bufferView",
         [](auto& b) {
             b.json["accessors"][0].erase("bufferView");
             b.json["accessors"][0]["count"] = 1000000000000U;
         }},
        {"component type unknown",
         "componentType",
         [](auto& b) { b.json["accessors"][0]["componentType"] = 5124; }},
        {"element type unknown", "VEC7", [](auto& b) { b.json["accessors"][0]["type"] = "VEC7"; }},
        {"positions of four components",
         "accessor 4: it has 4 components where 3 are needed",
         [](auto& b) { b.primitive(0)["attributes"]["POSITION"] = 4; }},
        {"sparse index out of range",
         "accessor 0 sparse: an index is not below 3",
         [](auto& b) {
             const int which = b.add_view(GltfBuilder::packed<std::uint8_t>({3}));
             b.json["buffers"][0]["byteLength"] = b.bytes.size();
             b.json["accessors"][0]["sparse"] = {
                 {"count", 1},
                 {"indices", {{"bufferView", which}, {"componentType", 5121}}},
                 {"values", {{"bufferView", 0}}}};
         }},
        {"sparse count huge",
         "accessor 0 sparse",
         [](auto& b) {
             b.json["accessors"][0]["sparse"] = {
                 {"count", 2000000000},
                 {"indices", {{"bufferView", 0}, {"componentType", 5121}}},
                 {"values", {{"bufferView", 0}}}};
         }},
        {"sparse without values",
         "accessor 0 sparse: values is missing",
         [](auto& b) {
             b.json["accessors"][0]["sparse"] = {
                 {"count", 1}, {"indices", {{"bufferView", 0}, {"componentType", 5121}}}};
         }},
        {"vertex index out of range",
         "accessor 1: index 17 is not below 3, the number of vertices",
         [](auto& b) {
             const auto offset = b.json["bufferViews"][1]["byteOffset"].template get<std::size_t>();
             b.bytes[offset] = 17;
         }},
        {"indices that are floats",
         "accessor 0: it has 3 components",
         [](auto& b) { b.primitive(0)["indices"] = 0; }},
        {"two indices", "holds no triangles", [](auto& b) { b.json["accessors"][1]["count"] = 2; }},
        {"indices accessor out of range",
         "mesh 0 primitive 0: indices: index 77",
         [](auto& b) { b.primitive(0)["indices"] = 77; }},
        {"attribute out of range",
         "NORMAL: index 55",
         [](auto& b) { b.primitive(0)["attributes"]["NORMAL"] = 55; }},
        {"material out of range",
         "material: index 4 is not below 1",
         [](auto& b) { b.primitive(0)["material"] = 4; }},
        {"mode unknown", "mode 9", [](auto& b) { b.primitive(0)["mode"] = 9; }},
        {"no attributes",
         "attributes is missing",
         [](auto& b) { b.primitive(0).erase("attributes"); }},
        {"NaN position",
         "accessor 0: element 1 is not a finite number",
         [](auto& b) { put_float(b, 0, 4, kNan); }},
        {"infinite position",
         "accessor 0: element 2 is not a finite number",
         [](auto& b) { put_float(b, 0, 8, -kInfinity); }},
        {"position beyond 1e12",
         "accessor 0: element 0 lies beyond 1e12 m",
         [](auto& b) { put_float(b, 0, 0, 2e12F); }},
        {"NaN displacement",
         "accessor 2: element 0 is not a finite number",
         [](auto& b) { put_float(b, 2, 0, kNan); }},
        {"scale that blows up",
         "beyond 1e12 m once its node has moved it",
         [](auto& b) {
             b.json["nodes"][1]["scale"] = {1e300, 1e300, 1e300};
             b.json["nodes"].push_back({{"scale", {1e300, 1, 1}}, {"children", {1}}});
         }},
        {"listener beyond 1e12 m",
         "listener \"far\" lies beyond 1e12 m",
         [](auto& b) {
             b.json["nodes"].push_back({{"name", "far"},
                                        {"translation", {1e13, 0, 0}},
                                        {"extras", {{"acoustics", {{"role", "listener"}}}}}});
             b.json["scenes"][0]["nodes"].push_back(2);
         }},
        {"too few displacements",
         "target 0 has 2 displacements for 3 vertices",
         [](auto& b) { b.json["accessors"][2]["count"] = 2; }},
        {"child out of range",
         "node 1: children: index 9 is not below 2",
         [](auto& b) { b.json["nodes"][1]["children"] = {9}; }},
        {"node its own parent",
         "node 1: it is its own ancestor",
         [](auto& b) { b.json["nodes"][1]["children"] = {1}; }},
        {"cycle of two",
         "it is its own ancestor",
         [](auto& b) {
             b.json["nodes"][1]["children"] = {0};
             b.json["nodes"][0]["children"] = {1};
         }},
        {"two parents",
         "node 1: it is a child of node 0 and of node 2",
         [](auto& b) {
             b.json["nodes"][0]["children"] = {1};
             b.json["nodes"].push_back({{"children", {1}}});
         }},
        {"mesh out of range",
         "node 0: mesh: index 3 is not below 1",
         [](auto& b) { b.json["nodes"][0]["mesh"] = 3; }},
        {"matrix of nine",
         "node 1: matrix does not hold 16 numbers",
         [](auto& b) {
             b.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
         }},
        {"matrix that projects",
         "node 1: the last row of its matrix",
         [](auto& b) {
             b.json["nodes"][1]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
         }},
        {"translation of texts",
         "node 1: translation contains other values than numbers",
         [](auto& b) {
             b.json["nodes"][1]["translation"] = {"a", "b", "c"};
         }},
        {"rotation of length 0",
         "node 1: its rotation is not a unit quaternion",
         [](auto& b) {
             b.json["nodes"][1]["rotation"] = {0, 0, 0, 0};
         }},
        {"scene out of range",
         "scene: index 5 is not below 1",
         [](auto& b) { b.json["scene"] = 5; }},
        {"scene node out of range",
         "scene 0: nodes: index 12",
         [](auto& b) { b.json["scenes"][0]["nodes"] = {12}; }},
        {"empty scene",
         "holds no triangles",
         [](auto& b) { b.json["scenes"][0]["nodes"] = Json::array(); }},
        {"no meshes",
         "node 0: mesh: index 0 is not below 0",
         [](auto& b) { b.json.erase("meshes"); }},
        {"skin out of range",
         "node 0: skin: index 1 is not below 1",
         [](auto& b) { b.json["nodes"][0]["skin"] = 1; }},
        {"skin joint out of range",
         "skin 0: joints: index 40 is not below 2",
         [](auto& b) { b.json["skins"][0]["joints"] = {40}; }},
        {"skin without joints",
         "skin 0: it has no joints",
         [](auto& b) { b.json["skins"][0]["joints"] = Json::array(); }},
        {"too few bind matrices",
         "skin 0: 1 inverse bind matrices for 2 joints",
         [](auto& b) {
             b.json["skins"][0]["joints"] = {1, 0};
         }},
        {"vertex joint out of range",
         "vertex 0 has a negative weight or a joint index that is not below 1",
         [](auto& b) {
             const auto offset = b.json["bufferViews"][3]["byteOffset"].template get<std::size_t>();
             b.bytes[offset] = 9;
         }},
        {"negative weight",
         "vertex 0 has a negative weight",
         [](auto& b) { put_float(b, 4, 0, -1.0F); }},
        {"joints without weights",
         "JOINTS and WEIGHTS of set 0 do not go together",
         [](auto& b) { b.primitive(0)["attributes"].erase("WEIGHTS_0"); }},
        {"skin without joints attribute",
         "it has no JOINTS_0",
         [](auto& b) {
             b.primitive(0)["attributes"].erase("JOINTS_0");
             b.primitive(0)["attributes"].erase("WEIGHTS_0");
         }},
        {"fewer weights than vertices",
         "the number of joints or weights is not the number of vertices",
         [](auto& b) { b.json["accessors"][4]["count"] = 2; }},
        {"sampler out of range",
         "channel 0: sampler: index 8 is not below 3",
         [](auto& b) { b.json["animations"][0]["channels"][0]["sampler"] = 8; }},
        {"sampler input out of range",
         "sampler 0: input: index 80",
         [](auto& b) { b.json["animations"][0]["samplers"][0]["input"] = 80; }},
        {"target node out of range",
         "target: node: index 6",
         [](auto& b) { b.json["animations"][0]["channels"][0]["target"]["node"] = 6; }},
        {"outputs do not fit",
         "animation 0 channel 0: 3 output numbers do not fit 2 key times of 3",
         [](auto& b) { b.json["accessors"][7]["count"] = 1; }},
        {"key times descend",
         "animation 0 channel 0: its key times are not strictly ascending",
         [](auto& b) { put_float(b, 6, 0, 5.0F); }},
        {"NaN key time", "accessor 6: element 0", [](auto& b) { put_float(b, 6, 0, kNan); }},
        {"key value beyond 1e12",
         "animation 0 channel 0: a key value lies beyond 1e12",
         [](auto& b) { put_float(b, 7, 0, 1e20F); }},
        {"interpolation unknown",
         "its interpolation is WOBBLE",
         [](auto& b) { b.json["animations"][0]["samplers"][0]["interpolation"] = "WOBBLE"; }},
        {"two channels on one property",
         "another channel animates the same property",
         [](auto& b) {
             Json& channels = b.json["animations"][0]["channels"];
             channels.push_back(channels[0]);
         }},
        {"weights of a node without targets",
         "without morph targets",
         [](auto& b) { b.json["animations"][0]["channels"][1]["target"]["node"] = 1; }},
        {"morph weights do not fit",
         "2 morph weights for 1 targets",
         [](auto& b) {
             b.json["nodes"][0]["weights"] = {1, 2};
         }},
        {"role unknown",
         "node \"joint\": its role is \"singer\"",
         [](auto& b) { b.json["nodes"][1]["extras"]["acoustics"]["role"] = "singer"; }},
        {"two sources of one name",
         "two sources are named \"joint\"",
         [](auto& b) {
             b.json["nodes"][0]["name"] = "joint";
             for (auto& node : b.json["nodes"]) {
                 node["extras"]["acoustics"]["role"] = "source";
             }
         }},
        {"audio emitter out of range",
         "its audio emitter 2 is not below 0",
         [](auto& b) { b.json["nodes"][1]["extensions"]["KHR_audio_emitter"]["emitter"] = 2; }},
    };
    return kFaults;
}

/// The line of the error, or what went wrong instead.
std::string line_for(const test::TemporaryFolder& folder, const std::string& bytes) {
    const std::filesystem::path file = folder.file("scene.glb", bytes);
    try {
        load_scene(file);
        return "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), file.string());
        EXPECT_FALSE(error.remedy().empty()) << error.line();
        return error.line();
    } catch (const std::exception& error) {
        return std::string("not an earshot::Error: ") + error.what();
    }
}

TEST(GltfFaults, TheFileTheyAreMadeFromIsGood) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(line_for(folder, everything().glb()), "no error");
}

TEST(GltfFaults, EachIsOneClearLine) {
    const test::TemporaryFolder folder;
    ASSERT_GE(faults().size(), 40U);
    for (const Fault& fault : faults()) {
        GltfBuilder builder = everything();
        fault.make(builder);
        const std::string line = line_for(folder, builder.glb());
        EXPECT_NE(line.find(fault.expected), std::string::npos) << fault.what << ": " << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << fault.what;
        EXPECT_LT(line.size(), 400U) << fault.what;
    }
}

TEST(GltfFaults, BrokenContainersAndJson) {
    const test::TemporaryFolder folder;
    const std::string good = everything().glb();
    const std::string word = GltfBuilder::word(7);
    const std::vector<std::pair<std::string, std::string>> bad{
        {"glTF", "header is incomplete"},
        {good.substr(0, 11), "header is incomplete"},
        {good.substr(0, 12), "truncated"},
        {good.substr(0, 18), "truncated"},
        {good.substr(0, 200), "truncated"},
        {good.substr(0, good.size() - 4), "truncated"},
        {"glTF" + word + good.substr(8), "GLB version 7"},
        {good.substr(0, 12) + "\xff\xff\xff\x7f" + good.substr(16), "claims 2147483647 bytes"},
        {good.substr(0, 16) + "XXXX" + good.substr(20), "first GLB chunk is not JSON"},
        {"{\"asset\": ", "JSON cannot be read"},
        {"{\"asset\": {\"version\": \"2.0\"}, }", "JSON cannot be read"},
        {"{\"asset\": {\"version\": \"2.0\"}, \"x\": 1e999}", "JSON cannot be read"},
        {"{\"asset\": {\"version\": \"2.0\"}, \"x\": NaN}", "JSON cannot be read"},
        {"\xff\xfe\x00", "JSON cannot be read"},
        {"null", "not a glTF object"},
        {"{}", "no glTF asset"},
        {"{\"asset\": {\"version\": \"2.0\"}}", "holds no triangles"},
        {std::string(100000, '['), "nested more than"},
    };
    for (const auto& [bytes, expected] : bad) {
        const std::string line = line_for(folder, bytes);
        EXPECT_NE(line.find(expected), std::string::npos) << line;
    }
}

TEST(GltfFaults, TruncatedOrDamagedFilesNeverCrash) {
    const test::TemporaryFolder folder;
    const std::string good = everything().glb();
    for (std::size_t part = 0; part < 50; ++part) {
        const std::string line = line_for(folder, good.substr(0, good.size() * part / 50));
        EXPECT_NE(line, "no error") << part;
        EXPECT_EQ(line.find("not an earshot::Error"), std::string::npos) << line;
    }
    for (std::size_t at = 12; at < good.size(); at += 3) {
        std::string damaged = good;
        damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 == 0 ? 0x11 : 0x80));
        const std::string line = line_for(folder, damaged);  // may well load
        EXPECT_EQ(line.find("not an earshot::Error"), std::string::npos) << at << ": " << line;
    }
}

}  // namespace
}  // namespace earshot::io
