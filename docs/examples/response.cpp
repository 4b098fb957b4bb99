// SPDX-License-Identifier: MIT
#include "earshot/earshot.h"

#include <iostream>

int main() {
    const earshot::Room room = earshot::load("scenes/concert_hall.gltf");
    const earshot::Responses responses = earshot::simulate(room, {.order = 3});
    const earshot::Response& response = responses.at("soloist", "stalls_front");
    response.write_wav("soloist__stalls_front.wav");
    std::cout << "T30 " << response.t30().value_or(0.0) << " s, from " << response.paths.size()
              << " paths and " << response.channels[0].samples.size() << " samples\n";
}
