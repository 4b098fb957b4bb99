// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/io/contacts.h"
#include "earshot/io/report.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace earshot::io {

/// Contacts of meshes that move, for a page.
struct ContactsPage {
    std::string title{};
    ReportProvenance provenance{};
    ContactReport contacts{};
    /// Of all meshes, and the mesh of each; empty: the page shows no meshes. Must outlive the call.
    std::span<const geometry::Triangle> triangles{};
    std::span<const std::uint32_t> mesh_of_triangle{};
    /// Positions of all vertices at a time of the steps.
    std::function<std::vector<geometry::Vec3>(double)> positions_at{};
    Warnings warnings{};
};

/// Bounds of what a page holds; what is left out is told in its warnings.
inline constexpr std::size_t kMaxReportInstants = 60;         ///< at which meshes are shown
inline constexpr std::size_t kMaxReportPositions = 700000;    ///< vertices, over all instants
inline constexpr std::size_t kMaxReportContacts = 5000;       ///< every second, third, ... one
inline constexpr std::size_t kMaxReportContactSteps = 20000;  ///< the first

/// The data of the page, the same bytes from run to run.
std::string encode_contacts_page(const ContactsPage& page);

/// Reads contacts.json. Throws Error naming the file if it is not what it should be.
ContactReport read_contacts(const ReportFile& file);

}  // namespace earshot::io
