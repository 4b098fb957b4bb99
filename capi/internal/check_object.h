// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/object_table.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/propagation/model_check.h"
#include "earshot/propagation/model_findings.h"
#include "earshot/propagation/model_mending.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace earshot::capi {

/// A scene as it was when it was checked. Never changes.
struct CheckedScene {
    io::LoadedScene loaded;
    propagation::ReadAs read_as{};
    bool has_unit_option = false;
    double time = 0.0;
};

/// A check and its views. Never changes.
struct CheckObject : ObjectOf<ES_KIND_MODEL_CHECK> {
    CheckObject(std::shared_ptr<const CheckedScene> checked, propagation::ModelReport model_report);

    std::shared_ptr<const CheckedScene> scene;
    propagation::ModelReport report;
    std::vector<propagation::Finding> findings;
    std::string unit, up;  // proposed
    std::vector<es_leak> leaks;
    std::vector<es_hole> holes;
    std::vector<es_misplaced> misplaced;
    std::array<std::vector<es_face_group>, 2> faces;  // by es_face_fault
    std::vector<es_air> airs;
    std::array<std::vector<std::uint32_t>, 2> air_of;  // of sources, of listeners
    std::vector<std::string> doubts;                   // per material
    std::vector<es_material_use> materials;
    std::vector<es_small_facets> small_facets;
    std::vector<es_order_cost> costs;
};

/// A mended copy. Never changes.
struct MendingObject : ObjectOf<ES_KIND_MENDING> {
    MendingObject(std::shared_ptr<const CheckedScene> checked, propagation::MendedModel model)
        : scene(std::move(checked)), mended(std::move(model)) {}

    std::shared_ptr<const CheckedScene> scene;  // that was mended
    propagation::MendedModel mended;
};

}  // namespace earshot::capi
