// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace earshot::io {

/// A name and a text.
using TextAttribute = std::pair<std::string, std::string>;

/// Makes a netCDF-4 file in memory: HDF5 with a dimension scale per dimension, in the form that the
/// netCDF library writes. The bytes depend on what is written alone; they carry no times. Every
/// function throws Error naming the file if HDF5 fails.
class Netcdf4Writer {
public:
    /// `name`: of the file, for errors.
    explicit Netcdf4Writer(std::string name);
    ~Netcdf4Writer();
    Netcdf4Writer(const Netcdf4Writer&) = delete;
    Netcdf4Writer& operator=(const Netcdf4Writer&) = delete;

    /// An attribute of the file.
    void add_attribute(const TextAttribute& attribute);

    /// Precondition: size > 0.
    void add_dimension(char name, std::size_t size);

    /// Doubles in row-major order. `dimensions`: the letters of dimensions that have been added.
    /// Precondition: as many values as they span.
    void add_variable(const std::string& name,
                      const std::string& dimensions,
                      const std::vector<double>& values,
                      const std::vector<TextAttribute>& attributes = {});

    /// Completes the file and returns its bytes. Call it once, last.
    std::string finish();

private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace earshot::io
