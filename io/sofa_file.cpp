// SPDX-License-Identifier: MIT
#include "earshot/io/internal/sofa_file.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/hdf5_handle.h"

#include <algorithm>
#include <array>

namespace earshot::io {

namespace {

constexpr std::array kVariables = {"Data.IR",
                                   "Data.Delay",
                                   "Data.SamplingRate",
                                   "SourcePosition",
                                   "SourceView",
                                   "SourceUp",
                                   "EmitterPosition",
                                   "ListenerPosition",
                                   "ListenerView",
                                   "ListenerUp",
                                   "ReceiverPosition"};

constexpr std::size_t kMaxTextSize = 1U << 16U;  // bytes of an attribute

/// Whether the last failure of HDF5 was for want of memory.
bool is_out_of_memory() {
    bool result = false;
    const auto look = [](unsigned, const H5E_error2_t* error, void* found) -> herr_t {
        *static_cast<bool*>(found) |= error->min_num == H5E_NOSPACE;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look, &result);
    return result;
}

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : name_(file.string()), file_(open(file)) {}

    SofaFile read() const {
        SofaFile sofa;
        sofa.attributes = texts_of(file_, {"Conventions", "SOFAConventions", "DataType"});
        for (const char* variable : kVariables) {
            if (exists(variable)) {
                sofa.variables.emplace(variable, read_variable(variable));
            }
        }
        return sofa;
    }

private:
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Error(name_, what, remedy);
    }

    [[noreturn]] void fail_to_read(const std::string& subject) const {
        if (is_out_of_memory()) {
            fail("HDF5 runs out of memory over " + subject, "fetch or export it again");
        }
        fail("is damaged: HDF5 cannot read " + subject, "fetch or export it again");
    }

    Hdf5Handle valid(hid_t id, herr_t (*close)(hid_t), const std::string& subject) const {
        Hdf5Handle handle(id, close);
        if (!handle.is_valid()) {
            fail_to_read(subject);
        }
        return handle;
    }

    Hdf5Handle open(const std::filesystem::path& file) const {
        // Whoever calls wants one line, and filters are those that HDF5 has built in: a file must
        // not make it load libraries.
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        H5PLset_loading_state(0);
        const Hdf5Handle access = valid(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "it");
        // Files on media that cannot be locked are read all the same.
        H5Pset_file_locking(access, false, true);
        if (H5Fis_hdf5(file.c_str()) <= 0) {
            fail("is not a SOFA file: it has no HDF5 signature", "give a SOFA file (AES69)");
        }
        return valid(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "it");
    }

    bool exists(const char* variable) const {
        const htri_t found = H5Lexists(file_, variable, H5P_DEFAULT);
        if (found < 0) {
            fail_to_read("its table of contents");
        }
        if (found == 0) {
            return false;
        }
        H5L_info_t info{};
        if (H5Lget_info(file_, variable, &info, H5P_DEFAULT) < 0) {
            fail_to_read(variable);
        }
        if (info.type != H5L_TYPE_HARD && info.type != H5L_TYPE_SOFT) {
            fail_to_stay_inside(variable);
        }
        return true;
    }

    [[noreturn]] void fail_to_stay_inside(const std::string& variable) const {
        fail("keeps " + variable + " in another file", "export it into one file");
    }

    SofaVariable read_variable(const std::string& variable) const {
        const Hdf5Handle data =
            valid(H5Dopen2(file_, variable.c_str(), H5P_DEFAULT), H5Dclose, variable);
        SofaVariable result;
        result.attributes = texts_of(data, {"Type", "Units"});
        check_storage(data, variable);
        const Hdf5Handle type = valid(H5Dget_type(data), H5Tclose, variable);
        const H5T_class_t kind = H5Tget_class(type);
        if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
            fail(variable + " holds no numbers", "export it again");
        }
        result.shape = shape_of(data, variable);
        std::size_t count = 1;
        for (const std::size_t size : result.shape) {
            if (size > 0 && count > kMaxSofaValues / size) {
                fail(variable + " is declared with more than " + std::to_string(kMaxSofaValues) +
                         " values",
                     "use a smaller set");
            }
            count *= size;
        }
        result.values.resize(count);
        if (count > 0 &&
            H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data()) <
                0) {
            fail_to_read(variable);
        }
        return result;
    }

    /// Refuses data in other files and filters that are not there.
    void check_storage(hid_t data, const std::string& variable) const {
        const Hdf5Handle creation = valid(H5Dget_create_plist(data), H5Pclose, variable);
        if (H5Pget_external_count(creation) != 0 || H5Pget_layout(creation) == H5D_VIRTUAL) {
            fail_to_stay_inside(variable);
        }
        const int filters = H5Pget_nfilters(creation);
        for (int i = 0; i < filters; ++i) {
            unsigned flags = 0;
            std::size_t values = 0;
            std::array<char, 64> label{};
            const H5Z_filter_t filter = H5Pget_filter2(creation,
                                                       static_cast<unsigned>(i),
                                                       &flags,
                                                       &values,
                                                       nullptr,
                                                       label.size(),
                                                       label.data(),
                                                       nullptr);
            if (filter < 0) {
                fail_to_read(variable);
            }
            if (H5Zfilter_avail(filter) <= 0) {
                label.back() = '\0';
                fail(variable + " is compressed by the filter " + std::to_string(filter) +
                         (label[0] == '\0' ? "" : std::string(" (") + label.data() + ")") +
                         ", which HDF5 does not have here",
                     "compress it with gzip");
            }
        }
    }

    std::vector<std::size_t> shape_of(hid_t data, const std::string& variable) const {
        const Hdf5Handle space = valid(H5Dget_space(data), H5Sclose, variable);
        std::array<hsize_t, H5S_MAX_RANK> sizes{};
        const int rank = H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
        if (rank < 0) {
            fail_to_read(variable);
        }
        if (H5Sget_simple_extent_type(space) == H5S_NULL) {
            return {0};
        }
        return {sizes.begin(), sizes.begin() + rank};
    }

    std::map<std::string, std::string> texts_of(hid_t object,
                                                std::initializer_list<const char*> names) const {
        std::map<std::string, std::string> texts;
        for (const char* name : names) {
            const htri_t found = H5Aexists(object, name);
            if (found < 0) {
                fail_to_read(name);
            }
            if (found > 0) {
                texts.emplace(name, text_of(object, name));
            }
        }
        return texts;
    }

    std::string text_of(hid_t object, const char* name) const {
        const Hdf5Handle attribute = valid(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
        const Hdf5Handle type = valid(H5Aget_type(attribute), H5Tclose, name);
        const Hdf5Handle space = valid(H5Aget_space(attribute), H5Sclose, name);
        if (H5Sget_simple_extent_type(space) == H5S_NULL) {
            return {};
        }
        const std::size_t size = H5Tget_size(type);
        if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1 ||
            size > kMaxTextSize) {
            fail(std::string("its attribute ") + name + " is not a text", "export it again");
        }
        std::string text;
        if (H5Tis_variable_str(type) > 0) {
            char* characters = nullptr;
            if (H5Aread(attribute, type, &characters) < 0) {
                fail_to_read(name);
            }
            if (characters != nullptr) {
                text = characters;
                H5free_memory(characters);
            }
        } else {
            text.resize(size);
            if (H5Aread(attribute, type, text.data()) < 0) {
                fail_to_read(name);
            }
        }
        text.resize(std::min(text.find('\0'), text.size()));
        text.resize(text.find_last_not_of(' ') + 1);
        return text;
    }

    std::string name_;
    Hdf5Handle file_;
};

}  // namespace

const SofaVariable* SofaFile::find(const std::string& name) const {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : &found->second;
}

std::string SofaFile::attribute(const std::string& name) const {
    const auto found = attributes.find(name);
    return found == attributes.end() ? "" : found->second;
}

SofaFile read_sofa_in_process(const std::filesystem::path& file) {
    return Reader(file).read();
}

}  // namespace earshot::io
