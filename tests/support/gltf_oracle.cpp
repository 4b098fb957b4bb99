// SPDX-License-Identifier: MIT
#include "support/gltf_oracle.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace earshot::test {
namespace {

using Json = nlohmann::json;
using Numbers = std::vector<double>;
using Matrix = std::array<std::array<double, 4>, 4>;  // [row][column]

const Matrix kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t k = 0; k < 4; ++k) {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    return c;
}

Point moved(const Matrix& m, const Point& p) {
    Point q{};
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3];
    }
    return q;
}

Matrix from_columns(const double* numbers) {
    Matrix m{};
    for (std::size_t i = 0; i < 16; ++i) {
        m[i % 4][i / 4] = numbers[i];
    }
    return m;
}

/// T R S, the quaternion of any length.
Matrix compose(const Numbers& t, const Numbers& q, const Numbers& s) {
    const double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double x = q[0];
    const double y = q[1];
    const double z = q[2];
    const double w = q[3];
    Matrix r{{{1 - 2 * (y * y + z * z) / n, 2 * (x * y - z * w) / n, 2 * (x * z + y * w) / n, t[0]},
              {2 * (x * y + z * w) / n, 1 - 2 * (x * x + z * z) / n, 2 * (y * z - x * w) / n, t[1]},
              {2 * (x * z - y * w) / n, 2 * (y * z + x * w) / n, 1 - 2 * (x * x + y * y) / n, t[2]},
              {0, 0, 0, 1}}};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            r[i][j] *= s[j];
        }
    }
    return r;
}

std::string decoded_base64(const std::string& text) {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned long bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') {
            break;
        }
        bits = bits * 64 + alphabet.find(c);
        if (++count == 4) {
            for (const int shift : {16, 8, 0}) {
                bytes += static_cast<char>(bits >> shift & 255U);
            }
            bits = 0;
            count = 0;
        }
    }
    if (count > 1) {
        bits <<= static_cast<unsigned>(6 * (4 - count));
        bytes += static_cast<char>(bits >> 16U & 255U);
        if (count > 2) {
            bytes += static_cast<char>(bits >> 8U & 255U);
        }
    }
    return bytes;
}

/// Keys are unit quaternions but for the rounding of their storage.
Numbers unit(Numbers q) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& x : q) {
        x /= length;
    }
    return q;
}

class Evaluation {
public:
    explicit Evaluation(const std::filesystem::path& path) {
        std::ifstream stream(path, std::ios::binary);
        const std::string all{std::istreambuf_iterator<char>(stream), {}};
        if (all.substr(0, 4) == "glTF") {
            std::uint32_t length = 0;
            std::memcpy(&length, all.data() + 12, 4);
            json_ = Json::parse(all.substr(20, length));
            buffer_ = all.substr(28 + length);
        } else {
            json_ = Json::parse(all);
            const std::string uri = json_["buffers"][0]["uri"];
            buffer_ = decoded_base64(uri.substr(uri.find(',') + 1));
        }
    }

    std::vector<Point> triangles(std::size_t animation, double t) {
        t_ = t;
        if (json_.contains("animations")) {
            animate(json_["animations"].at(animation));
        }
        const Json& scene = json_["scenes"][json_.value("scene", 0U)];
        for (const Json& root : scene["nodes"]) {
            walk(root, kIdentity);
        }
        std::vector<Point> corners;
        for (const auto& [node, world] : world_) {  // ascending
            if (json_["nodes"][node].contains("mesh")) {
                add_mesh(node, corners);
            }
        }
        return corners;
    }

private:
    /// One number of an accessor as its component type and normalization say.
    double number_at(const Json& accessor, std::size_t offset) const {
        const int type = accessor["componentType"];
        const bool is_normalized = accessor.value("normalized", false);
        const char* at = buffer_.data() + offset;
        const auto read = [&](auto zero, double largest) {
            std::memcpy(&zero, at, sizeof zero);
            const auto value = static_cast<double>(zero);
            return is_normalized ? std::max(value / largest, -1.0) : value;
        };
        switch (type) {
            case 5120:
                return read(std::int8_t{}, 127);
            case 5121:
                return read(std::uint8_t{}, 255);
            case 5122:
                return read(std::int16_t{}, 32767);
            case 5123:
                return read(std::uint16_t{}, 65535);
            case 5125:
                return read(std::uint32_t{}, 1);
            case 5126:
                return read(float{}, 1);
            default:
                throw std::runtime_error("component type");
        }
    }

    Numbers numbers(std::size_t index) const {
        const std::map<std::string, std::size_t> widths{
            {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
        const std::map<int, std::size_t> sizes{
            {5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}};
        const Json& accessor = json_["accessors"][index];
        const std::size_t width = widths.at(accessor["type"]);
        const std::size_t size = sizes.at(accessor["componentType"]);
        const std::size_t count = accessor["count"];
        Numbers values(count * width, 0.0);
        const auto fetch =
            [&](const Json& view, std::size_t offset, std::size_t from, std::size_t to) {
                const std::size_t stride = view.value("byteStride", size * width);
                const std::size_t start = view.value("byteOffset", std::size_t{0}) + offset;
                for (std::size_t k = 0; k < width; ++k) {
                    values[to * width + k] = number_at(accessor, start + from * stride + k * size);
                }
            };
        if (accessor.contains("bufferView")) {
            for (std::size_t i = 0; i < count; ++i) {
                fetch(json_["bufferViews"][accessor["bufferView"].get<std::size_t>()],
                      accessor.value("byteOffset", std::size_t{0}),
                      i,
                      i);
            }
        }
        if (accessor.contains("sparse")) {
            const Json& sparse = accessor["sparse"];
            const Json& which = sparse["indices"];
            const Json& view = json_["bufferViews"][which["bufferView"].get<std::size_t>()];
            const std::size_t start = view.value("byteOffset", std::size_t{0}) +
                                      which.value("byteOffset", std::size_t{0});
            const Json index_accessor = {{"componentType", which["componentType"]}};
            const std::size_t step = sizes.at(which["componentType"]);
            for (std::size_t i = 0; i < sparse["count"].get<std::size_t>(); ++i) {
                const auto to =
                    static_cast<std::size_t>(number_at(index_accessor, start + i * step));
                fetch(json_["bufferViews"][sparse["values"]["bufferView"].get<std::size_t>()],
                      sparse["values"].value("byteOffset", std::size_t{0}),
                      i,
                      to);
            }
        }
        return values;
    }

    void animate(const Json& animation) {
        for (const Json& channel : animation["channels"]) {
            const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
            const std::size_t node = channel["target"]["node"];
            const std::string path = channel["target"]["path"];
            animated_[{node, path}] = sampled(numbers(sampler["input"]),
                                              numbers(sampler["output"]),
                                              sampler.value("interpolation", "LINEAR"),
                                              path == "rotation");
        }
    }

    /// Appendix C.
    Numbers sampled(const Numbers& times,
                    const Numbers& values,
                    const std::string& how,
                    bool is_rotation) const {
        const bool is_cubic = how == "CUBICSPLINE";
        const std::size_t width = values.size() / times.size() / (is_cubic ? 3 : 1);
        const auto part = [&](std::size_t key, std::size_t which) {
            const std::size_t first = is_cubic ? (3 * key + which) * width : key * width;
            return Numbers(values.begin() + static_cast<std::ptrdiff_t>(first),
                           values.begin() + static_cast<std::ptrdiff_t>(first + width));
        };
        if (t_ <= times.front()) {
            return part(0, 1);
        }
        if (t_ >= times.back()) {
            return part(times.size() - 1, 1);
        }
        std::size_t k = 0;
        while (times[k + 1] <= t_) {
            ++k;
        }
        if (how == "STEP") {
            return part(k, 1);
        }
        const double span = times[k + 1] - times[k];
        const double f = (t_ - times[k]) / span;
        const bool is_arc = is_rotation && !is_cubic;
        const Numbers a = is_arc ? unit(part(k, 1)) : part(k, 1);
        const Numbers b = is_arc ? unit(part(k + 1, 1)) : part(k + 1, 1);
        Numbers out(width);
        double share_a = 1 - f;
        double share_b = f;
        if (is_arc) {
            const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
            const double angle = std::acos(std::min(1.0, std::abs(dot)));
            if (angle > 1e-6) {  // below, a straight line differs from the arc by 1e-18
                share_a = std::sin(angle * (1 - f)) / std::sin(angle);
                share_b = std::sin(angle * f) / std::sin(angle);
            }
            share_b = dot < 0 ? -share_b : share_b;
        }
        for (std::size_t i = 0; i < width; ++i) {
            out[i] = share_a * a[i] + share_b * b[i];
            if (is_cubic) {
                out[i] = (2 * f * f * f - 3 * f * f + 1) * a[i] +
                         span * (f * f * f - 2 * f * f + f) * part(k, 2)[i] +
                         (-2 * f * f * f + 3 * f * f) * b[i] +
                         span * (f * f * f - f * f) * part(k + 1, 0)[i];
            }
        }
        return out;
    }

    Numbers property(std::size_t node, const std::string& path, const Numbers& otherwise) const {
        const auto found = animated_.find({node, path});
        return found != animated_.end() ? found->second
                                        : json_["nodes"][node].value(path, otherwise);
    }

    void walk(std::size_t node, const Matrix& parent) {
        const Json& json = json_["nodes"][node];
        const Matrix local = json.contains("matrix")
                                 ? from_columns(json["matrix"].get<Numbers>().data())
                                 : compose(property(node, "translation", {0, 0, 0}),
                                           property(node, "rotation", {0, 0, 0, 1}),
                                           property(node, "scale", {1, 1, 1}));
        world_[node] = product(parent, local);
        for (const Json& child : json.value("children", Json::array())) {
            walk(child, world_[node]);
        }
    }

    std::vector<Matrix> joints_of(std::size_t node) const {
        std::vector<Matrix> matrices;
        if (!json_["nodes"][node].contains("skin")) {
            return matrices;
        }
        const Json& skin = json_["skins"][json_["nodes"][node]["skin"].get<std::size_t>()];
        const Numbers bind = numbers(skin["inverseBindMatrices"]);
        for (std::size_t i = 0; i < skin["joints"].size(); ++i) {
            matrices.push_back(product(world_.at(skin["joints"][i].get<std::size_t>()),
                                       from_columns(bind.data() + 16 * i)));
        }
        return matrices;
    }

    void add_mesh(std::size_t node, std::vector<Point>& corners) {
        const Json& mesh = json_["meshes"][json_["nodes"][node]["mesh"].get<std::size_t>()];
        const std::vector<Matrix> joints = joints_of(node);
        for (const Json& primitive : mesh["primitives"]) {
            const std::size_t targets = primitive.value("targets", Json::array()).size();
            const Numbers weights =
                property(node, "weights", mesh.value("weights", Numbers(targets, 0.0)));
            Numbers base = numbers(primitive["attributes"]["POSITION"]);
            for (std::size_t i = 0; i < targets; ++i) {
                const Numbers shift = numbers(primitive["targets"][i]["POSITION"]);
                for (std::size_t k = 0; k < base.size(); ++k) {
                    base[k] += weights[i] * shift[k];
                }
            }
            const std::vector<Point> placed =
                joints.empty() ? rigid(base, world_.at(node)) : skinned(base, primitive, joints);
            if (!primitive.contains("indices")) {
                corners.insert(corners.end(), placed.begin(), placed.end());
                continue;
            }
            for (const double index : numbers(primitive["indices"])) {
                corners.push_back(placed[static_cast<std::size_t>(index)]);
            }
        }
    }

    static std::vector<Point> rigid(const Numbers& base, const Matrix& world) {
        std::vector<Point> placed;
        for (std::size_t i = 0; i < base.size(); i += 3) {
            placed.push_back(moved(world, {base[i], base[i + 1], base[i + 2]}));
        }
        return placed;
    }

    /// One blended matrix per vertex, its weights scaled to sum 1 (files store them rounded).
    std::vector<Point> skinned(const Numbers& base,
                               const Json& primitive,
                               const std::vector<Matrix>& joints) const {
        const Numbers which = numbers(primitive["attributes"]["JOINTS_0"]);
        const Numbers weights = numbers(primitive["attributes"]["WEIGHTS_0"]);
        std::vector<Point> placed;
        for (std::size_t i = 0; i < base.size() / 3; ++i) {
            Matrix blend{};
            double sum = 0;
            for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                sum += weights[k];
            }
            for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                const Matrix& joint = joints[static_cast<std::size_t>(which[k])];
                for (std::size_t r = 0; r < 4; ++r) {
                    for (std::size_t c = 0; c < 4; ++c) {
                        blend[r][c] += weights[k] / sum * joint[r][c];
                    }
                }
            }
            placed.push_back(moved(blend, {base[3 * i], base[3 * i + 1], base[3 * i + 2]}));
        }
        return placed;
    }

    double t_ = 0;
    Json json_;
    std::string buffer_;
    std::map<std::pair<std::size_t, std::string>, Numbers> animated_;
    std::map<std::size_t, Matrix> world_;  // of the nodes of the scene
};

}  // namespace

std::vector<std::vector<Point>> evaluate_gltf(const std::filesystem::path& file,
                                              std::size_t animation,
                                              const std::vector<double>& times) {
    Evaluation evaluation(file);
    std::vector<std::vector<Point>> frames;
    for (const double t : times) {
        frames.push_back(evaluation.triangles(animation, t));
    }
    return frames;
}

}  // namespace earshot::test
