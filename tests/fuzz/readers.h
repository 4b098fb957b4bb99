// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::test {

/// A reader of untrusted files, as libFuzzer and the replay tests call it.
struct Reader {
    std::string name;    ///< also of its folders of seeds and findings and of its dictionary
    std::string suffix;  ///< of the input file, which selects the format of a scene
    /// Reads a file and checks what the reader promises of its result. Throws Error for an invalid
    /// file; anything else that it throws is a finding.
    void (*read)(const std::filesystem::path& file) = nullptr;
    /// Corrects the lengths, counts and checksums of a mutated file, which otherwise is refused
    /// before the rest of it is read. Null: there are none.
    std::string (*repair)(std::string bytes) = nullptr;
};

/// How tests print a reader.
inline void PrintTo(const Reader& reader, std::ostream* stream) {
    *stream << reader.name;
}

/// All readers, by name.
const std::vector<Reader>& readers();

/// Throws std::out_of_range if there is none of that name.
const Reader& reader_named(std::string_view name);

enum class Outcome { read, refused };

/// Lets `reader` read these bytes as a file. An exception other than Error leaves the function, and
/// an Error that says that memory is exhausted becomes std::bad_alloc: both are findings. The file
/// is left where input_file() says until the process ends in order.
Outcome fuzz_one(const Reader& reader, std::string_view bytes);

/// The file through which the inputs of `reader` pass in this process, in memory where the system
/// has a file system for that.
const std::filesystem::path& input_file(const Reader& reader);

}  // namespace earshot::test
