// SPDX-License-Identifier: MIT
#include "earshot/io/contacts.h"

#include "earshot/io/internal/json_lines.h"

namespace earshot::io {

namespace {

using Json = nlohmann::ordered_json;
using collision::Contact;
using collision::Element;

Json to_json(const Element& element) {
    Json vertices = Json::array();
    for (std::size_t i = 0; i < element.size; ++i) {
        vertices.push_back(element.vertices[i]);
    }
    return {{"mesh", element.mesh}, {"element", std::move(vertices)}};
}

Json to_json(const geometry::Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

std::string cells_of(const Element& element) {
    std::string text = std::to_string(element.mesh) + ",";
    for (std::size_t i = 0; i < element.size; ++i) {
        text += (i == 0 ? "" : " ") + std::to_string(element.vertices[i]);
    }
    return text;
}

}  // namespace

std::string encode_contacts(const std::vector<ContactStep>& steps) {
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"steps\":", 1);
    for (const ContactStep& step : steps) {
        lines.add_record("{\"t0\":" + json_number(step.t0) + ",\"t1\":" + json_number(step.t1));
        lines.begin_list(",\"contacts\":", 2);
        for (const Contact& contact : step.contacts) {
            const Json json = {{"kind", collision::name_of(contact.kind)},
                               {"a", to_json(contact.a)},
                               {"b", to_json(contact.b)},
                               {"toi", contact.toi},
                               {"point", to_json(contact.point)},
                               {"normal", to_json(contact.normal)}};
            lines.add_record(json.dump());
        }
        lines.end_list();
        lines.append("}");
    }
    lines.end_list();
    return lines.finish();
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
