// SPDX-License-Identifier: MIT
// Equalises the HRIRs of a SOFA file and writes them in the form that io/default_hrir_set.cpp
// carries in the library. Run by the build.
#include "earshot/audio/diffuse_field.h"
#include "earshot/base/math.h"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using earshot::audio::Hrir;
using earshot::audio::HrirSet;

std::vector<double> read_dataset(hid_t file, const char* name, std::vector<hsize_t>& dimensions) {
    int rank = 0;
    if (H5LTget_dataset_ndims(file, name, &rank) < 0 || rank < 1) {
        throw std::runtime_error(std::string("there is no ") + name);
    }
    dimensions.resize(static_cast<std::size_t>(rank));
    H5LTget_dataset_info(file, name, dimensions.data(), nullptr, nullptr);
    std::size_t size = 1;
    for (const hsize_t dimension : dimensions) {
        size *= dimension;
    }
    std::vector<double> values(size);
    if (H5LTread_dataset_double(file, name, values.data()) < 0) {
        throw std::runtime_error(std::string("cannot read ") + name);
    }
    return values;
}

HrirSet read_kemar(const std::string& path) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) {
        throw std::runtime_error("cannot be opened");
    }
    std::vector<hsize_t> dimensions;
    const std::vector<double> rate = read_dataset(file, "Data.SamplingRate", dimensions);
    // Azimuth and elevation in degrees, and the distance in metres.
    const std::vector<double> positions = read_dataset(file, "SourcePosition", dimensions);
    const std::vector<double> samples = read_dataset(file, "Data.IR", dimensions);
    H5Fclose(file);
    if (dimensions.size() != 3 || dimensions[1] != 2 || positions.size() != 3 * dimensions[0]) {
        throw std::runtime_error("is not laid out as the KEMAR set is");
    }
    const auto taps = static_cast<std::ptrdiff_t>(dimensions[2]);
    HrirSet set{.sample_rate = rate.at(0), .directions{}, .centre_delay = 0.0};
    auto next = samples.begin();
    for (std::size_t i = 0; i < dimensions[0]; ++i) {
        const double azimuth = positions[3 * i] * earshot::math::kPi / 180.0;
        const double elevation = positions[3 * i + 1] * earshot::math::kPi / 180.0;
        set.directions.push_back(
            {.towards = {earshot::math::cos(elevation) * earshot::math::cos(azimuth),
                         earshot::math::cos(elevation) * earshot::math::sin(azimuth),
                         earshot::math::sin(elevation)},
             .left{next, next + taps},
             .right{next + taps, next + 2 * taps},
             .distance = positions[3 * i + 2]});
        next += 2 * taps;
    }
    return set;
}

template <class Value>
void write(std::ofstream& out, const Value& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

// Sample rate, centre delay, number of directions, samples per ear; then per direction the unit
// vector, the distance, and the samples of both ears. Little-endian, doubles but for the samples.
void write_set(const HrirSet& set, const std::string& path) {
    std::ofstream out(path, std::ios::binary);
    write(out, set.sample_rate);
    write(out, set.centre_delay);
    write(out, std::uint64_t{set.directions.size()});
    write(out, std::uint64_t{set.directions.at(0).left.size()});
    for (const Hrir& direction : set.directions) {
        write(out, direction.towards);
        write(out, direction.distance);
        for (const auto* ear : {&direction.left, &direction.right}) {
            for (const double sample : *ear) {
                write(out, static_cast<float>(sample));
            }
        }
    }
    if (!out.flush()) {
        throw std::runtime_error("cannot write " + path);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: make_default_hrir_set SOFA_FILE OUTPUT\n", stderr);
        return 2;
    }
    try {
        write_set(earshot::audio::diffuse_field_equalised(read_kemar(argv[1])), argv[2]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_default_hrir_set: %s: %s\n", argv[1], error.what());
        return 1;
    }
    return 0;
}
