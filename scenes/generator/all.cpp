// SPDX-License-Identifier: MIT
#include "earshot/scenes/models.h"

namespace earshot::scenes {

std::vector<SceneDraft> make_all() {
    return {make_shoebox(),
            make_lroom(),
            make_coupled_rooms(),
            make_classroom(),
            make_concert_hall(),
            make_door(),
            make_curtain(),
            make_city()};
}

}  // namespace earshot::scenes
