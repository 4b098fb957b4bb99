// SPDX-License-Identifier: MIT
#include "earshot/io/room_sofa.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <utility>

namespace earshot::io {

namespace {

using geometry::Vec3;

/// Owns an HDF5 identifier.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
        if (id < 0) {
            throw Error("responses.sofa", "the HDF5 library cannot create it", "");
        }
    }
    ~Handle() { close_(id_); }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): as the C API

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

void check(herr_t status) {
    if (status < 0) {
        throw Error("responses.sofa", "the HDF5 library cannot write it", "");
    }
}

/// A file in memory whose bytes depend on what is written alone.
class SofaFile {
public:
    SofaFile() : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), file_(create(access_), H5Fclose) {}

    void attribute(hid_t object, const char* name, const std::string& text) {
        const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
        check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)));
        const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
        const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose);
        check(H5Awrite(attribute, type, text.empty() ? "" : text.data()));
    }
    void attribute(const char* name, const std::string& text) { attribute(file_, name, text); }

    void dimension(const std::string& name, hsize_t size) {
        const std::vector<float> nothing(size, 0.0F);
        sizes_[name] = size;
        const Handle scale = dataset(name.c_str(), H5T_IEEE_F32BE, {size});
        check(H5Dwrite(scale, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, nothing.data()));
        std::array<char, 80> label{};
        std::snprintf(label.data(),
                      label.size(),
                      "This is a netCDF dimension but not a netCDF variable.%10llu",
                      static_cast<unsigned long long>(size));
        check(H5DSset_scale(scale, label.data()));
    }

    /// `dimensions`: a letter each. `attributes` in pairs.
    void variable(const char* name,
                  const std::string& dimensions,
                  const std::vector<double>& values,
                  const std::vector<std::pair<const char*, const char*>>& attributes = {}) {
        std::vector<hsize_t> extent;
        hsize_t count = 1;
        for (const char letter : dimensions) {
            extent.push_back(sizes_.at({letter}));
            count *= extent.back();
        }
        EARSHOT_ASSERT(count == values.size());
        const Handle data = dataset(name, H5T_IEEE_F64LE, extent);
        check(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
        for (unsigned i = 0; i < dimensions.size(); ++i) {
            const Handle scale(H5Dopen2(file_, std::string{dimensions[i]}.c_str(), H5P_DEFAULT),
                               H5Dclose);
            check(H5DSattach_scale(data, scale, i));
        }
        for (const auto& [key, text] : attributes) {
            attribute(data, key, text);
        }
    }

    std::string bytes() {
        check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
        const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
        check(size < 0 ? -1 : 0);
        std::string image(static_cast<std::size_t>(size), '\0');
        check(H5Fget_file_image(file_, image.data(), image.size()) < 0 ? -1 : 0);
        return image;
    }

private:
    static hid_t create(hid_t access) {
        constexpr std::size_t kGrowth = std::size_t{1} << 20;
        check(H5Pset_fapl_core(access, kGrowth, 0));
        // As netCDF has it: readers of SOFA know this form.
        check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18));
        const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
        check(H5Pset_obj_track_times(creation, false));
        check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
        return H5Fcreate("responses.sofa", H5F_ACC_TRUNC, creation, access);
    }

    Handle dataset(const char* name, hid_t type, const std::vector<hsize_t>& extent) {
        const Handle space(
            H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
        const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        check(H5Pset_obj_track_times(creation, false));
        return {H5Dcreate2(file_, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose};
    }

    Handle access_;
    Handle file_;
    std::map<std::string, hsize_t> sizes_;
};

void add_vector(const Vec3& v, std::vector<double>& values) {
    values.insert(values.end(), {v.x, -v.z, v.y});
}

void describe(const std::string& title, SofaFile& file) {
    constexpr const char* kNoDate = "1970-01-01 00:00:00";
    for (const auto& [name, text] : std::vector<std::pair<const char*, std::string>>{
             {"Conventions", "SOFA"},
             {"Version", "2.1"},
             {"SOFAConventions", "SingleRoomSRIR"},
             {"SOFAConventionsVersion", "1.0"},
             {"DataType", "FIR"},
             {"RoomType", "reverberant"},
             {"Title", title},
             {"DatabaseName", title},
             {"ListenerShortName", "simulated"},
             {"APIName", "earshot"},
             {"APIVersion", "1"},
             {"ApplicationName", "earshot"},
             {"AuthorContact", "none"},
             {"Organization", "none"},
             {"License", "none"},
             {"Comment", "Pressure re the free field at 1 m in front of the source."},
             {"DateCreated", kNoDate},
             {"DateModified", kNoDate}}) {
        file.attribute(name, text);
    }
}

}  // namespace

std::string encode_room_responses(const std::string& title,
                                  const std::vector<RoomMeasurement>& measurements) {
    EARSHOT_ASSERT(!measurements.empty());
    const std::size_t channels = measurements.front().channels.size();
    std::size_t length = 1;
    for (const RoomMeasurement& measurement : measurements) {
        length = std::max(length, measurement.channels.front().samples.size());
    }
    std::vector<double> samples, source, source_view, source_up, listener, view, up;
    samples.reserve(measurements.size() * channels * length);
    for (const RoomMeasurement& measurement : measurements) {
        add_vector(measurement.source.position, source);
        add_vector(measurement.source.front, source_view);
        add_vector(measurement.source.up, source_up);
        add_vector(measurement.listener.position, listener);
        add_vector(measurement.listener.front, view);
        add_vector(measurement.listener.up, up);
        for (const audio::ImpulseResponse& channel : measurement.channels) {
            samples.insert(samples.end(), channel.samples.begin(), channel.samples.end());
            samples.resize(samples.size() + length - channel.samples.size(), 0.0);
        }
    }
    SofaFile file;
    describe(title, file);
    file.dimension("M", measurements.size());
    file.dimension("R", channels);
    file.dimension("N", length);
    file.dimension("E", 1);
    file.dimension("C", 3);
    file.dimension("I", 1);
    const std::vector<std::pair<const char*, const char*>> cartesian = {{"Type", "cartesian"},
                                                                        {"Units", "metre"}};
    file.variable("ListenerPosition", "MC", listener, cartesian);
    file.variable("ListenerView", "MC", view, cartesian);
    file.variable("ListenerUp", "MC", up);
    file.variable("ReceiverPosition", "RCI", std::vector<double>(3 * channels, 0.0), cartesian);
    file.variable("SourcePosition", "MC", source, cartesian);
    file.variable("SourceView", "MC", source_view, cartesian);
    file.variable("SourceUp", "MC", source_up);
    file.variable("EmitterPosition", "ECI", {0.0, 0.0, 0.0}, cartesian);
    file.variable("Data.IR", "MRN", samples);
    file.variable("Data.Delay", "IR", std::vector<double>(channels, 0.0));
    file.variable("Data.SamplingRate",
                  "I",
                  {measurements.front().channels.front().sample_rate},
                  {{"Units", "hertz"}});
    return file.bytes();
}

}  // namespace earshot::io
