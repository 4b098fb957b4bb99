// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/contact.h"

#include <string>
#include <vector>

namespace earshot::io {

/// Contacts from one instant to the next.
struct ContactStep {
    double t0 = 0.0, t1 = 0.0;  ///< seconds, or numbers of poses
    std::vector<collision::Contact> contacts;
};

/// The text of contacts.json: one contact per line, numbers that read back as the same double.
std::string encode_contacts(const std::vector<ContactStep>& steps);

/// The same as a table with a header line, a line per contact; vertices of an element are separated
/// by blanks.
std::string encode_contacts_csv(const std::vector<ContactStep>& steps);

}  // namespace earshot::io
