// SPDX-License-Identifier: MIT
#include "collision_contenders.h"
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>

namespace bench {
namespace {

using earshot::collision::Pose;
using earshot::collision::TrianglePair;
using Model = coal::BVHModel<coal::OBBRSS>;

coal::Transform3s transform_of(const Pose& pose) {
    coal::Matrix3s rotation;
    coal::Vec3s translation;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            rotation(row, column) = pose.rotation[column][row];
        }
        translation[row] = pose.translation[row];
    }
    return {rotation, translation};
}

std::shared_ptr<Model> model_of(const earshot::geometry::MeshView& mesh) {
    std::vector<coal::Vec3s> vertices;
    for (const auto& position : mesh.positions) {
        vertices.emplace_back(position.x, position.y, position.z);
    }
    std::vector<coal::Triangle> triangles;
    for (const auto& triangle : mesh.triangles) {
        triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
    auto model = std::make_shared<Model>();
    model->beginModel(static_cast<unsigned>(triangles.size()),
                      static_cast<unsigned>(vertices.size()));
    model->addSubModel(vertices, triangles);
    model->endModel();
    return model;
}

void refit_model(Model& model, const earshot::geometry::MeshView& mesh) {
    std::vector<coal::Vec3s> vertices;
    for (const auto& position : mesh.positions) {
        vertices.emplace_back(position.x, position.y, position.z);
    }
    model.beginReplaceModel();
    model.replaceSubModel(vertices);
    model.endReplaceModel(true, true);
}

class Coal : public DiscreteContender {
public:
    void build(const earshot::geometry::MeshView& a,
               const earshot::geometry::MeshView& b) override {
        a_ = model_of(a);
        b_ = model_of(b);
    }

    void refit(const earshot::geometry::MeshView& a,
               const earshot::geometry::MeshView& b) override {
        refit_model(*a_, a);
        refit_model(*b_, b);
    }

    bool intersects(const Pose& pose) override {
        const coal::CollisionRequest request(coal::NO_REQUEST, 1);
        coal::CollisionResult result;
        coal::collide(
            a_.get(), coal::Transform3s::Identity(), b_.get(), transform_of(pose), request, result);
        return result.isCollision();
    }

    double distance(const Pose& pose) override {
        const coal::DistanceRequest request(true);
        coal::DistanceResult result;
        coal::distance(
            a_.get(), coal::Transform3s::Identity(), b_.get(), transform_of(pose), request, result);
        return result.min_distance;
    }

    std::vector<TrianglePair> contacts(const Pose& pose) override {
        constexpr std::size_t kAll = 100000000;
        const coal::CollisionRequest request(coal::CONTACT, kAll);
        coal::CollisionResult result;
        coal::collide(
            a_.get(), coal::Transform3s::Identity(), b_.get(), transform_of(pose), request, result);
        std::vector<TrianglePair> pairs;
        for (std::size_t i = 0; i < result.numContacts(); ++i) {
            const auto& contact = result.getContact(i);
            pairs.push_back({static_cast<earshot::geometry::TriangleId>(contact.b1),
                             static_cast<earshot::geometry::TriangleId>(contact.b2)});
        }
        return pairs;
    }

private:
    std::shared_ptr<Model> a_, b_;
};

}  // namespace

std::unique_ptr<DiscreteContender> coal_contender() {
    return std::make_unique<Coal>();
}

}  // namespace bench
