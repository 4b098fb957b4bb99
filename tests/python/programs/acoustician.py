# SPDX-License-Identifier: MIT
# STI at every seat of a classroom in noise: which seats are bad, and what the room does.
import earshot as es

room = es.extrude([(0, 0), (9, 0), (9, 4), (5, 4), (5, 7), (0, 7)], height=3.2)
room.assign({"floor": "carpet-thin", "ceiling": es.Material(0.3, scattering=0.2)}, default=0.1)
room.add_source("teacher", (1, 1.6, 1), directivity="cardioid", look_at=(5, 1.2, 3))
room.add_listeners(room.grid(height=1.2, step=1.8, clearance=0.5), "seat")
print(room.check())
result = es.simulate(room, order=3, rays=20000, noise="NC-30", speech="raised")
print(result.table(["t30_mid", "c50_mid", "sti"]))
print("below 0.6:", [seat for seat, sti in zip(result.listeners, result.sti[0]) if sti < 0.6])
print("Eyring", result.room.eyring.round(2))
result["teacher", "seat 1"].plot_decay().figure.savefig("decay.png")
result.write("classroom")
