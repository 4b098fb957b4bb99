// SPDX-License-Identifier: MIT
// What a world's searches find.
#include "earshot/base/parallel.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/work.h"
#include "earshot/capi/internal/world_object.h"

#include <memory>
#include <set>
#include <utility>

namespace earshot::capi {
namespace {

constexpr es_contact_options kDefaults = {.struct_size = sizeof(es_contact_options),
                                          .between_meshes = 1,
                                          .within_meshes = 0,
                                          .moving_only = 0,
                                          .threads = 1,
                                          .min_separation = 0.0,
                                          .tolerance = 1e-6,
                                          .pairs = nullptr,
                                          .pair_count = 0};

es_contact_options checked(const es_contact_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_contact_options whole =
        require_struct(*options, kDefaults, sizeof(es_contact_options), "options");
    require_flag(whole.between_meshes, "options->between_meshes");
    require_flag(whole.within_meshes, "options->within_meshes");
    require_flag(whole.moving_only, "options->moving_only");
    require_threads(whole.threads, "options->threads");
    require_in(whole.min_separation, 0.0, 1e6, "options->min_separation");
    require_in(whole.tolerance, 1e-12, 1.0, "options->tolerance");
    require_array(reinterpret_cast<const std::pair<std::uint32_t, std::uint32_t>*>(whole.pairs),
                  whole.pair_count,
                  "options->pairs");
    return whole;
}

/// The options of a search of this world.
class Search {
public:
    Search(const WorldObject& world, const es_contact_options* options)
        : given_(checked(options)), executor_(given_.threads) {
        for (std::size_t i = 0; i < given_.pair_count; ++i) {
            const std::uint32_t a = given_.pairs[2 * i], b = given_.pairs[2 * i + 1];
            require_index(a, world.meshes.size(), "options->pairs");
            require_index(b, world.meshes.size(), "options->pairs");
            pairs_.insert(std::minmax(a, b));
        }
        if (given_.moving_only != 0) {
            for (std::uint32_t mesh = 0; mesh < world.meshes.size(); ++mesh) {
                moves_.push_back(!world.meshes[mesh].is_removed && world.world.moves(mesh) ? 1 : 0);
            }
        }
    }

    Executor& executor() noexcept { return executor_; }

    collision::ContactOptions options() const {
        collision::ContactOptions options = {.between_meshes = given_.between_meshes != 0,
                                             .within_meshes = given_.within_meshes != 0,
                                             .min_separation = given_.min_separation,
                                             .tolerance = given_.tolerance};
        if (given_.pairs != nullptr || given_.moving_only != 0) {
            options.filter = [this](std::uint32_t a, std::uint32_t b) {
                return (given_.pairs == nullptr || pairs_.count({a, b}) > 0) &&
                       (moves_.empty() || moves_[a] != 0 || moves_[b] != 0);
            };
        }
        return options;
    }

private:
    es_contact_options given_;
    Executor executor_;
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;
    std::vector<std::uint8_t> moves_;  // per mesh; empty: that does not matter
};

template <typename T>
void copy_vector(const geometry::Vec3& from, T& to) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
    }
}

es_element element_of(const collision::Element& element) {
    return {.mesh = element.mesh,
            .vertex_count = element.size,
            .vertices = {element.vertices[0], element.vertices[1], element.vertices[2]}};
}

es_contact contact_of(const collision::Contact& found) {
    es_contact contact{};
    contact.kind = found.kind == collision::ContactKind::vertex_face ? ES_CONTACT_VERTEX_FACE
                   : found.kind == collision::ContactKind::edge_edge ? ES_CONTACT_EDGE_EDGE
                                                                     : ES_CONTACT_TRIANGLE_TRIANGLE;
    contact.a = element_of(found.a);
    contact.b = element_of(found.b);
    contact.toi = found.toi;
    copy_vector(found.point, contact.point);
    copy_vector(found.normal, contact.normal);
    return contact;
}

es_contacts publish_contacts(const std::vector<collision::Contact>& found) {
    std::vector<es_contact> contacts;
    contacts.reserve(found.size());
    for (const collision::Contact& contact : found) {
        contacts.push_back(contact_of(contact));
    }
    return publish(std::make_shared<ContactsObject>(std::move(contacts)));
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_contact_options_init(es_contact_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_contact_options)); });
}

es_status es_world_contacts(es_world world,
                            const es_contact_options* options,
                            es_contacts* contacts) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(contacts, "contacts");
        Search search(*object, options);
        *contacts = publish_contacts(object->world.contacts(search.options(), search.executor()));
    });
}

es_status es_world_first_contact(es_world world,
                                 const es_contact_options* options,
                                 es_contact* contact,
                                 int32_t* found) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(contact, "contact");
        require(found, "found");
        Search search(*object, options);
        const auto first = object->world.first_contact(search.options(), search.executor());
        if (first) {
            *contact = contact_of(*first);
        }
        *found = first ? 1 : 0;
    });
}

es_status es_world_intersections(es_world world,
                                 const es_contact_options* options,
                                 es_contacts* contacts) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(contacts, "contacts");
        Search search(*object, options);
        *contacts =
            publish_contacts(object->world.contacts_at_begin(search.options(), search.executor()));
    });
}

es_status es_contacts_get(es_contacts contacts, const es_contact** array, size_t* count) {
    return call(__func__, [&] {
        const Reading<ContactsObject> object(contacts, "contacts");
        require(array, "array");
        require(count, "count") = object->contacts.size();
        *array = object->contacts.data();
    });
}

es_status es_world_distance(
    es_world world, uint32_t a, uint32_t b, int32_t threads, es_distance* distance) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(distance, "distance");
        require_threads(threads, "threads");
        static_cast<void>(require_mesh(*object, a, "a"));
        static_cast<void>(require_mesh(*object, b, "b"));
        Executor executor(threads);
        const collision::MeshDistance found = object->world.distance_at_begin(a, b, executor);
        const bool is_apart = found.distance > 0.0 && std::isfinite(found.distance);
        es_distance result{};
        result.distance = found.distance;
        result.triangle_a = is_apart ? found.triangles.a : ES_NONE;
        result.triangle_b = is_apart ? found.triangles.b : ES_NONE;
        copy_vector(found.on_a, result.on_a);
        copy_vector(found.on_b, result.on_b);
        *distance = result;
    });
}

es_status es_world_depth(es_world world, uint32_t a, uint32_t b, es_depth* depth) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(depth, "depth");
        static_cast<void>(require_mesh(*object, a, "a"));
        static_cast<void>(require_mesh(*object, b, "b"));
        const auto found = object->world.depth_at_begin(a, b);
        es_depth result{};
        if (found) {
            result.overlap = 1;
            result.depth = found->depth;
            copy_vector(found->move, result.move);
            result.part_a = found->part_a;
            result.part_b = found->part_b;
        }
        *depth = result;
    });
}
