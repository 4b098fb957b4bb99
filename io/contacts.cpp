// SPDX-License-Identifier: MIT
#include "earshot/io/contacts.h"

#include "earshot/io/internal/json_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <span>

namespace earshot::io {

namespace {

using collision::Contact;
using collision::Element;

/// Appends to a text. Numbers look as nlohmann-json writes them, without a JSON value for each.
class Writer {
public:
    explicit Writer(std::string& text) : text_(text) {}

    Writer& operator<<(std::string_view text) {
        text_ += text;
        return *this;
    }
    Writer& operator<<(std::uint32_t number) {
        std::array<char, 16> digits{};
        char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
        text_.append(digits.data(), end);
        return *this;
    }
    Writer& operator<<(double number) {
        if (!std::isfinite(number)) {
            return *this << "null";
        }
        std::array<char, 64> digits{};
        const char* first = digits.data();
        const char* end =
            nlohmann::detail::to_chars(digits.data(), digits.data() + digits.size(), number);
        text_.append(first, end);
        return *this;
    }
    Writer& operator<<(const geometry::Vec3& v) {
        return *this << "[" << v.x << "," << v.y << "," << v.z << "]";
    }
    Writer& operator<<(const Element& element) {
        *this << "{\"mesh\":" << element.mesh << ",\"element\":[";
        for (std::size_t i = 0; i < element.size; ++i) {
            *this << (i == 0 ? "" : ",") << element.vertices[i];
        }
        return *this << "]}";
    }

private:
    std::string& text_;
};

void append(const Contact& contact, std::string& text) {
    Writer(text) << "{\"kind\":\"" << collision::name_of(contact.kind) << "\",\"a\":" << contact.a
                 << ",\"b\":" << contact.b << ",\"toi\":" << contact.toi
                 << ",\"point\":" << contact.point << ",\"normal\":" << contact.normal << "}";
}

void append(const PairDistance& pair, std::string& text) {
    Writer writer(text);
    writer << "{\"a\":" << pair.a << ",\"b\":" << pair.b;
    if (pair.distance) {
        writer << ",\"distance\":" << pair.distance->distance;
        if (pair.distance->distance > 0.0 && std::isfinite(pair.distance->distance)) {
            writer << ",\"triangles\":[" << pair.distance->triangles.a << ","
                   << pair.distance->triangles.b << "],\"points\":[" << pair.distance->on_a << ","
                   << pair.distance->on_b << "]";
        }
    }
    if (pair.depth) {
        writer << ",\"depth\":" << pair.depth->depth << ",\"move\":" << pair.depth->move
               << ",\"parts\":[" << pair.depth->part_a << "," << pair.depth->part_b << "]";
    }
    writer << "}";
}

/// Gives records, a line each, to the sink. They are encoded in parallel, some at a time.
template <typename Record>
void write_records(std::span<const Record> records,
                   std::string_view indent,
                   const ByteSink& sink,
                   Executor& executor) {
    constexpr std::size_t kChunk = 1024;
    constexpr std::size_t kChunksAtATime = 64;
    for (std::size_t first = 0; first < records.size(); first += kChunk * kChunksAtATime) {
        const auto some =
            records.subspan(first, std::min(kChunk * kChunksAtATime, records.size() - first));
        std::vector<std::string> texts(chunk_count(some.size(), kChunk));
        executor.for_each(some.size(), kChunk, [&](std::size_t begin, std::size_t end) {
            std::string& text = texts[begin / kChunk];
            for (std::size_t i = begin; i < end; ++i) {
                text += first + i == 0 ? "\n" : ",\n";
                text += indent;
                append(some[i], text);
            }
        });
        for (const std::string& text : texts) {
            sink(text);
        }
    }
}

std::string cells_of(const Element& element) {
    std::string text = std::to_string(element.mesh) + ",";
    for (std::size_t i = 0; i < element.size; ++i) {
        text += (i == 0 ? "" : " ") + std::to_string(element.vertices[i]);
    }
    return text;
}

}  // namespace

void write_contacts(const ContactReport& report, const ByteSink& sink, Executor& executor) {
    sink("{\"version\":1,\"meshes\":" + json_text(nlohmann::ordered_json(report.meshes)) +
         ",\"steps\":[");
    for (std::size_t i = 0; i < report.steps.size(); ++i) {
        const ContactStep& step = report.steps[i];
        sink((i == 0 ? "\n {\"t0\":" : ",\n {\"t0\":") + json_number(step.t0) +
             ",\"t1\":" + json_number(step.t1) + ",\"contacts\":[");
        write_records(std::span(step.contacts), "  ", sink, executor);
        sink("]");
        if (step.distances) {
            sink(",\"distances\":[");
            write_records(std::span(*step.distances), "  ", sink, executor);
            sink("]");
        }
        sink("}");
    }
    sink("]}\n");
}

std::string encode_contacts(const ContactReport& report) {
    std::string text;
    write_contacts(report, [&](std::string_view piece) { text += piece; });
    return text;
}

std::string encode_contacts_csv(const std::vector<ContactStep>& steps) {
    std::string text = "t0,t1,kind,mesh_a,a,mesh_b,b,toi,x,y,z,nx,ny,nz\n";
    for (const ContactStep& step : steps) {
        for (const Contact& contact : step.contacts) {
            text += json_number(step.t0) + "," + json_number(step.t1) + "," +
                    std::string(collision::name_of(contact.kind)) + "," + cells_of(contact.a) +
                    "," + cells_of(contact.b) + "," + json_number(contact.toi) + "," +
                    json_numbers(contact.point) + "," + json_numbers(contact.normal) + "\n";
        }
    }
    return text;
}

}  // namespace earshot::io
