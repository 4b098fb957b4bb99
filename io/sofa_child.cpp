// SPDX-License-Identifier: MIT
// read_sofa(): the reader of sofa_file.cpp in a child process, and the bytes in which the child
// hands back what it has read.
#include "earshot/base/error.h"
#include "earshot/io/internal/bytes.h"
#include "earshot/io/internal/child_process.h"
#include "earshot/io/internal/sofa_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <unistd.h>

namespace earshot::io {

namespace {

namespace fs = std::filesystem;

// How the bytes begin.
enum class Reply : std::uint8_t { error = 1, file = 2 };

using Texts = std::map<std::string, std::string>;

void write_texts(const Texts& texts, ByteWriter& writer) {
    writer.leb128(texts.size());
    for (const auto& [key, text] : texts) {
        writer.string(key);
        writer.string(text);
    }
}

Texts read_texts(ByteReader& reader) {
    Texts texts;
    for (std::size_t left = reader.count(2); left > 0; --left) {
        std::string key = reader.string();
        texts[std::move(key)] = reader.string();
    }
    return texts;
}

SofaVariable receive_variable(ByteReader& reader) {
    SofaVariable variable;
    variable.attributes = read_texts(reader);
    std::size_t product = 1;
    for (std::size_t left = reader.count(1); left > 0; --left) {
        variable.shape.push_back(reader.leb128());
        // No product of sizes that fit overflows.
        if (variable.shape.back() > kMaxSofaValues || product > kMaxSofaValues) {
            reader.fail("a variable is too large");
        }
        product *= variable.shape.back();
    }
    const std::size_t count = reader.count(sizeof(double));
    if (count != product) {
        reader.fail("a variable is incomplete");
    }
    const std::string_view bytes = reader.raw(count * sizeof(double));
    if (count > 0) {
        variable.values.resize(count);
        std::memcpy(variable.values.data(), bytes.data(), bytes.size());
    }
    return variable;
}

[[noreturn]] void throw_end(const std::string& file, ChildEnd end, const ChildLimits& limits) {
    const std::string remedy = "it is damaged or hostile; fetch or export it again";
    switch (end) {
        case ChildEnd::time:
            throw Error(file,
                        "HDF5 does not finish reading it within " +
                            std::to_string(static_cast<int>(limits.processor_time)) +
                            " s of processor time",
                        remedy);
        case ChildEnd::memory:
        case ChildEnd::output:
            throw Error(file,
                        "takes more than " + std::to_string(limits.memory >> 20U) +
                            " MiB of memory to read",
                        remedy);
        case ChildEnd::not_started:
            throw Error(file,
                        "cannot be read: the system starts no process to read it in",
                        "end other programs");
        default:
            throw Error(file, "HDF5 crashes while reading it", remedy);
    }
}

// Tells what every reader tells of a file that is not there, before a process is started.
void require_readable(const fs::path& file) {
    std::error_code failure;
    const fs::file_status status = fs::status(file, failure);
    if (status.type() == fs::file_type::not_found) {
        throw Error(file.string(), "no such file", "check the name and the directory");
    }
    if (status.type() != fs::file_type::regular) {
        throw Error(file.string(),
                    fs::is_directory(status) ? "is a directory, not a file" : "is not a file",
                    "name a SOFA file");
    }
    if (::access(file.c_str(), R_OK) != 0) {
        throw Error(file.string(),
                    "cannot be read: " + std::generic_category().message(errno),
                    "check its permissions");
    }
}

}  // namespace

void send_sofa_reply(const SofaFile& sofa, const ByteSink& sink) {
    ByteWriter head;
    head.fixed(static_cast<std::uint64_t>(Reply::file), 1);
    write_texts(sofa.attributes, head);
    head.leb128(sofa.variables.size());
    sink(head.bytes());
    for (const auto& [name, variable] : sofa.variables) {
        ByteWriter writer;
        writer.string(name);
        write_texts(variable.attributes, writer);
        writer.leb128(variable.shape.size());
        for (const std::size_t size : variable.shape) {
            writer.leb128(size);
        }
        writer.leb128(variable.values.size());
        sink(writer.bytes());
        // Both processes are of one machine: doubles go as they are.
        sink({reinterpret_cast<const char*>(variable.values.data()),
              variable.values.size() * sizeof(double)});
    }
}

SofaFile decode_sofa_reply(std::string_view bytes, const std::string& file) {
    ByteReader reader(bytes, file);
    const auto kind = static_cast<Reply>(reader.fixed(1));
    if (kind == Reply::error) {
        const std::string what = reader.string();
        throw Error(file, what, reader.string());
    }
    if (kind != Reply::file) {
        reader.fail("the reading process says neither what it has read nor why not");
    }
    SofaFile sofa;
    sofa.attributes = read_texts(reader);
    for (std::size_t left = reader.count(1); left > 0; --left) {
        std::string name = reader.string();
        sofa.variables[std::move(name)] = receive_variable(reader);
    }
    return sofa;
}

SofaFile read_sofa(const fs::path& file) {
    require_readable(file);
    const ChildLimits limits;
    const ChildResult result = run_in_child(limits, [&](const ByteSink& sink) {
        try {
            send_sofa_reply(read_sofa_in_process(file), sink);
        } catch (const Error& error) {
            ByteWriter writer;
            writer.fixed(static_cast<std::uint64_t>(Reply::error), 1);
            writer.string(error.what());
            writer.string(error.remedy());
            sink(writer.bytes());
        }
    });
    if (result.end != ChildEnd::finished) {
        throw_end(file.string(), result.end, limits);
    }
    return decode_sofa_reply(result.output, file.string());
}

}  // namespace earshot::io
