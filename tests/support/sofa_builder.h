// SPDX-License-Identifier: MIT
// SOFA files by plain calls of HDF5, in more forms than the writer under test has. Link HDF5.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace earshot::test {

/// A variable as it will be stored.
struct SofaBuilderVariable {
    std::vector<hsize_t> shape;
    std::vector<double> values;
    std::map<std::string, std::string> attributes{};
};

/// What a file will hold and how it is stored.
class SofaBuilder {
public:
    std::map<std::string, std::string> attributes{};
    std::map<std::string, SofaBuilderVariable> variables{};
    hid_t type = H5T_IEEE_F64LE;    ///< of all values
    bool is_compressed = false;     ///< in chunks, by shuffle and zlib
    H5Z_filter_t extra_filter = 0;  ///< optional one after them, without effect where it is absent
    bool has_variable_texts = false;  ///< attributes of variable length, in UTF-8
    bool is_earliest_format = false;  ///< superblock version 0, as by HDF5 1.6
    std::string external_file{};      ///< in which Data.IR lies, if not empty

    /// Throws std::runtime_error if HDF5 fails.
    void write(const std::filesystem::path& path) const {
        const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_libver_bounds(access,
                             is_earliest_format ? H5F_LIBVER_EARLIEST : H5F_LIBVER_V18,
                             is_earliest_format ? H5F_LIBVER_LATEST : H5F_LIBVER_V18);
        const hid_t file = checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access));
        H5Pclose(access);
        for (const auto& [name, text] : attributes) {
            write_text(file, name, text);
        }
        for (const auto& [name, variable] : variables) {
            write_variable(file, name, variable);
        }
        checked(H5Fclose(file));
    }

private:
    template <typename Status>
    static Status checked(Status status) {
        if (status < 0) {
            throw std::runtime_error("HDF5 does not write a SOFA file");
        }
        return status;
    }

    void write_text(hid_t object, const std::string& name, const std::string& text) const {
        const hid_t text_type = H5Tcopy(H5T_C_S1);
        H5Tset_size(text_type,
                    has_variable_texts ? H5T_VARIABLE : std::max<std::size_t>(text.size(), 1));
        H5Tset_cset(text_type, has_variable_texts ? H5T_CSET_UTF8 : H5T_CSET_ASCII);
        const hid_t space = H5Screate(H5S_SCALAR);
        const hid_t attribute =
            checked(H5Acreate2(object, name.c_str(), text_type, space, H5P_DEFAULT, H5P_DEFAULT));
        const char* characters = text.c_str();
        checked(H5Awrite(attribute,
                         text_type,
                         has_variable_texts ? static_cast<const void*>(&characters)
                                            : static_cast<const void*>(characters)));
        H5Aclose(attribute);
        H5Sclose(space);
        H5Tclose(text_type);
    }

    void write_variable(hid_t file,
                        const std::string& name,
                        const SofaBuilderVariable& variable) const {
        const hid_t space = H5Screate_simple(
            static_cast<int>(variable.shape.size()), variable.shape.data(), nullptr);
        const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
        if (is_compressed) {
            std::vector<hsize_t> chunk = variable.shape;
            chunk[0] = (chunk[0] + 1) / 2;
            H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
            H5Pset_shuffle(creation);
            H5Pset_deflate(creation, 5);
            if (extra_filter != 0) {
                H5Pset_filter(creation, extra_filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
            }
        }
        if (!external_file.empty() && name == "Data.IR") {
            H5Pset_external(creation, external_file.c_str(), 0, H5F_UNLIMITED);
        }
        const hid_t data = checked(
            H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT));
        if (!variable.values.empty()) {
            checked(H5Dwrite(
                data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, variable.values.data()));
        }
        for (const auto& [key, text] : variable.attributes) {
            write_text(data, key, text);
        }
        H5Dclose(data);
        H5Pclose(creation);
        H5Sclose(space);
    }
};

/// A head that is none: from 12 azimuths and at two elevations, two impulses per ear that tell the
/// ear and the measurement. 1.4 m away, 48 kHz, left receiver first.
struct SyntheticHead {
    static constexpr std::size_t kMeasurements = 24;
    static constexpr std::size_t kLength = 32;

    static double azimuth_deg(std::size_t m) { return 30.0 * static_cast<double>(m % 12); }
    static double elevation_deg(std::size_t m) { return m < 12 ? 0.0 : 40.0; }

    /// Front, left, up.
    static std::vector<double> towards(std::size_t m) {
        const double azimuth = azimuth_deg(m) * std::numbers::pi / 180.0;
        const double elevation = elevation_deg(m) * std::numbers::pi / 180.0;
        return {std::cos(elevation) * std::cos(azimuth),
                std::cos(elevation) * std::sin(azimuth),
                std::sin(elevation)};
    }

    /// `side`: 1 of the left ear, -1 of the right. Single precision holds every sample.
    static std::vector<double> response(std::size_t m, double side) {
        std::vector<double> samples(kLength, 0.0);
        const double shadow = side * towards(m)[1];
        samples[static_cast<std::size_t>(8.0 - std::round(4.0 * shadow))] =
            std::round(64.0 * (1.0 + 0.5 * shadow)) / 64.0;
        samples[side > 0.0 ? 20 : 21] = side * static_cast<double>(m + 1) / 128.0;
        return samples;
    }
};

/// The plain file of that head: SimpleFreeFieldHRIR with all that AES69 wants of it.
inline SofaBuilder synthetic_head_file() {
    SofaBuilder file;
    file.attributes = {{"Conventions", "SOFA"},
                       {"Version", "2.1"},
                       {"SOFAConventions", "SimpleFreeFieldHRIR"},
                       {"SOFAConventionsVersion", "1.2"},
                       {"DataType", "FIR"},
                       {"RoomType", "free field"}};
    const std::map<std::string, std::string> cartesian = {{"Type", "cartesian"},
                                                          {"Units", "metre"}};
    constexpr hsize_t kAll = SyntheticHead::kMeasurements;
    SofaBuilderVariable samples{{kAll, 2, SyntheticHead::kLength}, {}};
    SofaBuilderVariable sources{
        {kAll, 3}, {}, {{"Type", "spherical"}, {"Units", "degree, degree, metre"}}};
    for (std::size_t m = 0; m < kAll; ++m) {
        for (const double side : {1.0, -1.0}) {
            const std::vector<double> response = SyntheticHead::response(m, side);
            samples.values.insert(samples.values.end(), response.begin(), response.end());
        }
        sources.values.insert(
            sources.values.end(),
            {SyntheticHead::azimuth_deg(m), SyntheticHead::elevation_deg(m), 1.4});
    }
    file.variables = {
        {"Data.IR", samples},
        {"Data.SamplingRate", {{1}, {48000.0}, {{"Units", "hertz"}}}},
        {"Data.Delay", {{1, 2}, {0.0, 0.0}}},
        {"SourcePosition", sources},
        {"EmitterPosition", {{1, 3, 1}, {0.0, 0.0, 0.0}, cartesian}},
        {"ListenerPosition", {{1, 3}, {0.0, 0.0, 0.0}, cartesian}},
        {"ListenerView", {{1, 3}, {1.0, 0.0, 0.0}, cartesian}},
        {"ListenerUp", {{1, 3}, {0.0, 0.0, 1.0}}},
        {"ReceiverPosition", {{2, 3, 1}, {0.0, 0.09, 0.0, 0.0, -0.09, 0.0}, cartesian}}};
    return file;
}

}  // namespace earshot::test
