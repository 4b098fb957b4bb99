// SPDX-License-Identifier: MIT
#include "earshot/io/internal/result_files.h"
#include "earshot/io/report_contacts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using collision::Contact;
using collision::ContactKind;

ContactKind kind_of(const ReportFile& file, const std::string& name) {
    for (const ContactKind kind :
         {ContactKind::vertex_face, ContactKind::edge_edge, ContactKind::triangle_triangle}) {
        if (collision::name_of(kind) == name) {
            return kind;
        }
    }
    refuse_result_file(file, "has a contact of an unknown kind");
}

collision::Element element_of(const ReportFile& file, const Json& json) {
    const Json& vertices = json.at("element");
    collision::Element element{.mesh = result_index(file, json.at("mesh"))};
    if (!vertices.is_array() || vertices.empty() || vertices.size() > element.vertices.size()) {
        refuse_result_file(file, "has an element that is no vertex, edge or face");
    }
    for (const Json& vertex : vertices) {
        element.vertices[element.size++] = result_index(file, vertex);
    }
    return element;
}

geometry::Vec3 vector_of(const ReportFile& file, const Json& json) {
    if (json.size() != 3) {
        refuse_result_file(file, "holds a point without three coordinates");
    }
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Contact contact_of(const ReportFile& file, const Json& json) {
    const Contact contact{.kind = kind_of(file, json.at("kind").get<std::string>()),
                          .a = element_of(file, json.at("a")),
                          .b = element_of(file, json.at("b")),
                          .toi = json.at("toi").get<double>(),
                          .point = vector_of(file, json.at("point")),
                          .normal = vector_of(file, json.at("normal"))};
    if (!(contact.toi >= 0.0 && contact.toi <= 1.0)) {
        refuse_result_file(file, "has a time of impact that is not in its step");
    }
    return contact;
}

void check_meshes(const ReportFile& file, const ContactReport& report) {
    for (const ContactStep& step : report.steps) {
        for (const Contact& contact : step.contacts) {
            if (std::max(contact.a.mesh, contact.b.mesh) >= report.meshes.size()) {
                refuse_result_file(file, "has contacts of meshes that it does not name");
            }
        }
    }
}

}  // namespace

ContactReport read_contacts(const ReportFile& file) {
    constexpr int kStepDepth = 2;
    constexpr int kContactDepth = 4;
    ContactReport report;
    std::vector<Contact> contacts;
    const auto take = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (event != Json::parse_event_t::object_end) {
            return true;
        }
        // Those of "distances" have no kind; they are not shown.
        if (depth == kContactDepth && parsed.contains("kind")) {
            contacts.push_back(contact_of(file, parsed));
        } else if (depth == kStepDepth) {
            ContactStep& step = report.steps.emplace_back(ContactStep{
                .t0 = parsed.at("t0").get<double>(), .t1 = parsed.at("t1").get<double>()});
            if (!(step.t1 >= step.t0)) {
                refuse_result_file(file, "has a step that ends before it begins");
            }
            step.contacts = std::exchange(contacts, {});
        }
        return depth != kContactDepth && depth != kStepDepth;
    };
    read_result_file(file, [&] {
        const Json json = parse_result_file(file, take);
        report.meshes = json.at("meshes").get<std::vector<std::string>>();
        static_cast<void>(json.at("steps"));
    });
    check_meshes(file, report);
    return report;
}

}  // namespace earshot::io
