# SPDX-License-Identifier: MIT
# An arm swings over a shelf: what the camera sees of it, how near it comes, when it touches.
import numpy as np
import earshot as es

box, (shelf, arm) = es.shoebox((1, 1, 1)), ((2, 0.1, 1), (0.2, 0.2, 0.8))
cube, faces = box.vertices, box.triangles
world, above = es.World(), cube * arm + [0.5, 0.6, 0.1]
world.add("shelf", cube * shelf, faces)
swung = world.add("arm", above, faces)
print(world.distance("arm", "shelf"))
world.step(swung, above, above - [0, 0.55, 0])
print(world.first_contact(), world.contacts(min_separation=0.02).where("arm"))
sight = es.Sight(np.concatenate([cube * shelf, above]), np.concatenate([faces, faces + len(cube)]))
print(sight.matrix([(1, 2, 0.5), (1, -1, 0.5)], above + [0, 0.5, 0]).sum(axis=1))
print(sight.move(np.concatenate([cube * shelf, above - [0, 0.55, 0]])))
