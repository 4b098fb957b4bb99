// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/io/internal/ply_header.h"
#include "earshot/io/internal/text.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// One element of a PLY file: a vertex, a face, ...
struct PlyRecord {
    std::vector<double> scalars;  ///< one per property, 0 in place of a list
    std::vector<double> list;     ///< the items of the list that was asked for
};

/// The body of a PLY file, element after element.
class PlyRecords {
public:
    virtual ~PlyRecords() = default;

    /// Reads the next element; `wanted` is one of its list properties or null. Throws Error naming
    /// the file and the line if the element is not whole.
    virtual void read(const PlyElement& element, const PlyProperty* wanted, PlyRecord& record) = 0;

    /// To be called after the last element: throws Error or warns of what follows it.
    virtual void finish(Warnings& warnings) = 0;
};

/// Binary elements in either byte order.
class BinaryPlyRecords : public PlyRecords {
public:
    BinaryPlyRecords(std::string_view body, PlyFormat format, const std::string& file)
        : rest_(body), format_(format), file_(file) {}

    void read(const PlyElement& element, const PlyProperty* wanted, PlyRecord& record) override;
    void finish(Warnings& warnings) override;

private:
    double next(PlyType type);

    std::string_view rest_;
    PlyFormat format_;
    const std::string& file_;
};

/// Text with one element per line, as Turk's reader wants it. Values that the header does not name
/// are left out at the end of a line, with a warning.
class LinePlyRecords : public PlyRecords {
public:
    /// `lines_before`: of the header, for the numbers of lines in errors.
    LinePlyRecords(std::string_view body, std::size_t lines_before, const std::string& file)
        : lines_(body), lines_before_(lines_before), file_(file) {}

    void read(const PlyElement& element, const PlyProperty* wanted, PlyRecord& record) override;
    void finish(Warnings& warnings) override;

    /// A line holds fewer values than its element has, or the lines end too early.
    class Short : public Error {
    public:
        using Error::Error;
    };

private:
    struct Surplus {
        std::string element;
        std::string where;  // the first such line
        std::size_t count = 0;
    };

    std::string where() const { return "line " + std::to_string(lines_before_ + lines_.number()); }
    bool next_line();
    double next(std::string_view& line, const PlyElement& element) const;

    Lines lines_;
    std::string_view line_;
    std::size_t lines_before_;
    const std::string& file_;
    std::vector<Surplus> surplus_;
};

/// Text whose elements follow one another whatever the lines are. Nothing may be left over.
class StreamPlyRecords : public PlyRecords {
public:
    StreamPlyRecords(std::string_view body, const std::string& file) : rest_(body), file_(file) {}

    void read(const PlyElement& element, const PlyProperty* wanted, PlyRecord& record) override;
    void finish(Warnings& warnings) override;

private:
    std::string_view next_word();
    double next();

    std::string_view rest_;
    const std::string& file_;
};

}  // namespace earshot::io
