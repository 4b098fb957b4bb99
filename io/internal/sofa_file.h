// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/whole_file.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// A variable of a SOFA file.
struct SofaVariable {
    std::vector<std::size_t> shape;                 ///< empty for a scalar
    std::vector<double> values;                     ///< row-major
    std::map<std::string, std::string> attributes;  ///< those of Type and Units that it has
};

/// What is read of a SOFA file: the variables of source, listener and responses, and the attributes
/// that say what kind of file it is.
struct SofaFile {
    std::map<std::string, std::string> attributes;
    std::map<std::string, SofaVariable> variables;

    /// Null if the file has no such variable.
    const SofaVariable* find(const std::string& name) const;
    /// Empty if the file has no such attribute.
    std::string attribute(const std::string& name) const;
};

/// Values that one variable may hold: 512 MiB of doubles.
inline constexpr std::size_t kMaxSofaValues = std::size_t{1} << 26U;

/// Reads a file with HDF5 in a child process, so that a crash, an endless loop or an exhausted
/// memory inside the library is an Error like any other. Throws Error naming the file if it is no
/// HDF5 file, is damaged, refers to other files, needs filters that are not there, or holds more
/// than kMaxSofaValues.
SofaFile read_sofa(const std::filesystem::path& file);

/// The same in this process: for files that are known to be sound, and for tests of the reader.
SofaFile read_sofa_in_process(const std::filesystem::path& file);

/// Gives what has been read to the sink, as the child process does.
void send_sofa_reply(const SofaFile& sofa, const ByteSink& sink);

/// The file in the bytes that the child process hands back. Throws the Error in them, or one that
/// names `file` if they are incomplete: what a damaged file has made of the child is not trusted.
SofaFile decode_sofa_reply(std::string_view bytes, const std::string& file);

}  // namespace earshot::io
