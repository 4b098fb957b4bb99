# SPDX-License-Identifier: MIT
# Random rooms with an array of four microphones: responses, and labels of their geometry.
import numpy as np
import earshot as es

random, items = np.random.default_rng(1), []
array = 0.05 * np.array([[1, 0, 0], [0, 0, 1], [-1, 0, 0], [0, 0, -1]])
for index in range(8):
    size = random.uniform((3, 2.5, 3), (9, 4, 9))
    room = es.shoebox(size, absorption=random.uniform(0.1, 0.6), scattering=0.1)
    source, centre = random.uniform(0.5, size - 0.5, (2, 3))
    room.add_source("talker", source)
    room.add_listeners(centre + array, "microphone")
    result = es.simulate(room, order=6, rays=1000, seed=index, sample_rate=16000, length=0.5)
    items.append((result.ir[0, :, 0], result.paths["talker", 0].arrival[0], result.t30[0, 0]))
print(np.stack([item[0] for item in items]).shape)
