// SPDX-License-Identifier: MIT
#include "collision_contenders.h"
#include <fcl/fcl.h>

namespace bench {
namespace {

using earshot::collision::Pose;
using earshot::collision::TrianglePair;
using Model = fcl::BVHModel<fcl::OBBRSSd>;

fcl::Transform3d transform_of(const Pose& pose) {
    fcl::Transform3d transform = fcl::Transform3d::Identity();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            transform.linear()(row, column) = pose.rotation[column][row];
        }
        transform.translation()[row] = pose.translation[row];
    }
    return transform;
}

std::shared_ptr<Model> model_of(const earshot::geometry::MeshView& mesh) {
    std::vector<fcl::Vector3d> vertices;
    for (const auto& position : mesh.positions) {
        vertices.emplace_back(position.x, position.y, position.z);
    }
    std::vector<fcl::Triangle> triangles;
    for (const auto& triangle : mesh.triangles) {
        triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    }
    auto model = std::make_shared<Model>();
    model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    model->addSubModel(vertices, triangles);
    model->endModel();
    return model;
}

void refit_model(Model& model, const earshot::geometry::MeshView& mesh) {
    std::vector<fcl::Vector3d> vertices;
    for (const auto& position : mesh.positions) {
        vertices.emplace_back(position.x, position.y, position.z);
    }
    model.beginReplaceModel();
    model.replaceSubModel(vertices);
    model.endReplaceModel(true, true);
}

class Fcl : public DiscreteContender {
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
        const fcl::CollisionRequestd request(1, false);
        fcl::CollisionResultd result;
        fcl::collide(
            a_.get(), fcl::Transform3d::Identity(), b_.get(), transform_of(pose), request, result);
        return result.isCollision();
    }

    double distance(const Pose& pose) override {
        const fcl::DistanceRequestd request(true);
        fcl::DistanceResultd result;
        fcl::distance(
            a_.get(), fcl::Transform3d::Identity(), b_.get(), transform_of(pose), request, result);
        return result.min_distance;
    }

    std::vector<TrianglePair> contacts(const Pose& pose) override {
        constexpr std::size_t kAll = 100000000;
        const fcl::CollisionRequestd request(kAll, true);
        fcl::CollisionResultd result;
        fcl::collide(
            a_.get(), fcl::Transform3d::Identity(), b_.get(), transform_of(pose), request, result);
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

std::unique_ptr<DiscreteContender> fcl_contender() {
    return std::make_unique<Fcl>();
}

}  // namespace bench
