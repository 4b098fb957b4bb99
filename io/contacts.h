// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/convex.h"
#include "earshot/collision/discrete.h"
#include "earshot/io/whole_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace earshot::io {

/// How far apart two meshes are, or how deep in each other.
struct PairDistance {
    std::uint32_t a = 0, b = 0;                         ///< meshes, a <= b
    std::optional<collision::MeshDistance> distance{};  ///< of their surfaces; not within a mesh
    std::optional<collision::SolidDepth> depth{};       ///< of convex solids that overlap
};

/// Contacts from one instant to the next.
struct ContactStep {
    double t0 = 0.0, t1 = 0.0;  ///< seconds, or numbers of poses
    std::vector<collision::Contact> contacts{};
    /// Of pairs of meshes at `t0`; nothing if they were not asked for.
    std::optional<std::vector<PairDistance>> distances{};
};

/// The contacts of a scene.
struct ContactReport {
    std::vector<std::string> meshes{};  ///< names, by number
    std::vector<ContactStep> steps{};
};

/// Gives the text of contacts.json to a sink, piece by piece: one contact per line, numbers that
/// read back as the same double. The same for any executor.
void write_contacts(const ContactReport& report,
                    const ByteSink& sink,
                    Executor& executor = Executor::serial());

/// All of that text.
std::string encode_contacts(const ContactReport& report);

/// The contacts as a table with a header line, a line per contact; vertices of an element are
/// separated by blanks.
std::string encode_contacts_csv(const std::vector<ContactStep>& steps);

}  // namespace earshot::io
