// SPDX-License-Identifier: MIT
#include "earshot/io/internal/netcdf4_writer.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/io/internal/bytes.h"
#include "earshot/io/internal/hdf5_handle.h"

#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

namespace earshot::io {

namespace {

// Callbacks of the core driver, which keep the file in a string of ours. H5Fget_file_image would
// not do: HDF5 1.10 clears the flags of the superblock in that copy but leaves the checksum over
// them, and other readers refuse the file. The buffer that is closed has been written in full.
using Image = std::string;

void* resize_image(void* /*memory*/, std::size_t size, H5FD_file_image_op_t, void* image) {
    try {
        static_cast<Image*>(image)->resize(size);
    } catch (const std::exception&) {
        return nullptr;
    }
    return static_cast<Image*>(image)->data();
}

herr_t leave_image(void* /*memory*/, H5FD_file_image_op_t, void* /*image*/) {
    return 0;
}

void* share_image(void* image) {
    return image;
}

herr_t keep_image(void* /*image*/) {
    return 0;
}

}  // namespace

struct Netcdf4Writer::File {
    explicit File(std::string file_name) : name(std::move(file_name)), handle(create(), H5Fclose) {
        require(handle.is_valid());
    }

    void require(bool success) const {
        if (!success) {
            throw Error(name, "the HDF5 library cannot write it", "check the memory that is left");
        }
    }
    void check(herr_t status) const { require(status >= 0); }

    Hdf5Handle valid(hid_t id, herr_t (*close)(hid_t)) const {
        Hdf5Handle result(id, close);
        require(result.is_valid());
        return result;
    }

    hid_t create() {
        const Hdf5Handle access = valid(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
        // The image grows by what is written and no more.
        check(H5Pset_fapl_core(access, 1, 0));
        H5FD_file_image_callbacks_t callbacks = {
            nullptr, nullptr, resize_image, leave_image, share_image, keep_image, &image};
        check(H5Pset_file_image_callbacks(access, &callbacks));
        check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18));
        const Hdf5Handle creation = valid(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
        check(H5Pset_obj_track_times(creation, false));
        // netCDF-4 numbers variables and attributes by the order of their creation.
        constexpr unsigned kOrder = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
        check(H5Pset_link_creation_order(creation, kOrder));
        check(H5Pset_attr_creation_order(creation, kOrder));
        return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation, access);
    }

    void add_text(hid_t object, const TextAttribute& attribute) const {
        const auto& [key, text] = attribute;
        const Hdf5Handle type = valid(H5Tcopy(H5T_C_S1), H5Tclose);
        check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)));
        const Hdf5Handle space = valid(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Handle made =
            valid(H5Acreate2(object, key.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        check(H5Awrite(made, type, text.empty() ? "" : text.data()));
    }

    void add_number(hid_t object, const char* key, int number) const {
        const Hdf5Handle space = valid(H5Screate(H5S_SCALAR), H5Sclose);
        const Hdf5Handle made = valid(
            H5Acreate2(object, key, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        check(H5Awrite(made, H5T_NATIVE_INT, &number));
    }

    Hdf5Handle dataset(const std::string& key, hid_t type, const std::vector<hsize_t>& extent) {
        const Hdf5Handle space = valid(
            H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
        const Hdf5Handle creation = valid(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        check(H5Pset_obj_track_times(creation, false));
        check(H5Pset_attr_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
        return valid(
            H5Dcreate2(handle, key.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
            H5Dclose);
    }

    std::string name;
    Image image;
    Hdf5Handle handle;
    std::map<char, hsize_t> sizes{};
};

Netcdf4Writer::Netcdf4Writer(std::string name) : file_(std::make_unique<File>(std::move(name))) {}
Netcdf4Writer::~Netcdf4Writer() = default;

void Netcdf4Writer::add_attribute(const TextAttribute& attribute) {
    file_->add_text(file_->handle, attribute);
}

void Netcdf4Writer::add_dimension(char name, std::size_t size) {
    EARSHOT_ASSERT(size > 0);
    const int number = static_cast<int>(file_->sizes.size());
    file_->sizes[name] = size;
    // netCDF-4 file format, "Dimensions": a dimension without a variable of its name is a dataset
    // of big-endian floats that are never written, marked by this text.
    const Hdf5Handle scale = file_->dataset({name}, H5T_IEEE_F32BE, {size});
    std::array<char, 80> label{};
    std::snprintf(label.data(),
                  label.size(),
                  "This is a netCDF dimension but not a netCDF variable.%10zu",
                  size);
    file_->check(H5DSset_scale(scale, label.data()));
    file_->add_number(scale, "_Netcdf4Dimid", number);
}

void Netcdf4Writer::add_variable(const std::string& name,
                                 const std::string& dimensions,
                                 const std::vector<double>& values,
                                 const std::vector<TextAttribute>& attributes) {
    std::vector<hsize_t> extent;
    hsize_t count = 1;
    for (const char letter : dimensions) {
        extent.push_back(file_->sizes.at(letter));
        count *= extent.back();
    }
    EARSHOT_ASSERT(count == values.size());
    const Hdf5Handle data = file_->dataset(name, H5T_IEEE_F64LE, extent);
    file_->check(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    for (unsigned i = 0; i < dimensions.size(); ++i) {
        const Hdf5Handle scale = file_->valid(
            H5Dopen2(file_->handle, std::string{dimensions[i]}.c_str(), H5P_DEFAULT), H5Dclose);
        file_->check(H5DSattach_scale(data, scale, i));
    }
    for (const TextAttribute& attribute : attributes) {
        file_->add_text(data, attribute);
    }
}

std::string Netcdf4Writer::finish() {
    file_->check(H5Fflush(file_->handle, H5F_SCOPE_GLOBAL));
    file_->require(file_->handle.close());
    // HDF5 gives back what it has reserved at the end, but leaves the image as long as it was.
    // HDF5 file format 3.0, II.A: version 2 of the superblock has the file's end at byte 28.
    constexpr std::size_t kEndOfFile = 28;
    ByteReader superblock(file_->image, file_->name);
    superblock.raw(kEndOfFile);
    const std::uint64_t size = superblock.fixed(8);
    EARSHOT_ASSERT(size <= file_->image.size());
    file_->image.resize(size);
    return std::move(file_->image);
}

}  // namespace earshot::io
