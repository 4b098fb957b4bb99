// SPDX-License-Identifier: MIT
#include "earshot/io/contacts.h"

#include <nlohmann/json.hpp>

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

/// With the fewest digits that read back as the same double.
std::string digits(double value) {
    return Json(value).dump();
}

std::string digits(const geometry::Vec3& v) {
    return digits(v.x) + "," + digits(v.y) + "," + digits(v.z);
}

}  // namespace

std::string encode_contacts(const std::vector<ContactStep>& steps) {
    std::string text = "{\"version\":1,\"steps\":[";
    for (std::size_t i = 0; i < steps.size(); ++i) {
        text += (i == 0 ? "\n" : ",\n") + std::string(" {\"t0\":") + digits(steps[i].t0) +
                ",\"t1\":" + digits(steps[i].t1) + ",\"contacts\":[";
        const char* separator = "\n";
        for (const Contact& contact : steps[i].contacts) {
            const Json json = {{"kind", collision::name_of(contact.kind)},
                               {"a", to_json(contact.a)},
                               {"b", to_json(contact.b)},
                               {"toi", contact.toi},
                               {"point", to_json(contact.point)},
                               {"normal", to_json(contact.normal)}};
            text += separator + std::string("  ") + json.dump();
            separator = ",\n";
        }
        text += "]}";
    }
    return text + "]}\n";
}

std::string encode_contacts_csv(const std::vector<ContactStep>& steps) {
    std::string text = "t0,t1,kind,mesh_a,a,mesh_b,b,toi,x,y,z,nx,ny,nz\n";
    for (const ContactStep& step : steps) {
        for (const Contact& contact : step.contacts) {
            text += digits(step.t0) + "," + digits(step.t1) + "," +
                    std::string(collision::name_of(contact.kind)) + "," + cells_of(contact.a) +
                    "," + cells_of(contact.b) + "," + digits(contact.toi) + "," +
                    digits(contact.point) + "," + digits(contact.normal) + "\n";
        }
    }
    return text;
}

}  // namespace earshot::io
