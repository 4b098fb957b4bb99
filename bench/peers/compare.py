# SPDX-License-Identifier: MIT
"""One job, by earshot and by its peers, in turns: the response of a shoe-box by image sources.

Prints medians of processor time in milliseconds and ratios to earshot's. README.md says in what
the programs differ.
"""

import statistics
import subprocess
import sys
import time

SAMPLE_RATE = 48000
SIZE = [8.0, 3.5, 6.0]
SOURCE = [2.0, 1.7, 1.5]
ABSORPTION = 0.1
BANDS_HZ = [125, 250, 500, 1000, 2000, 4000, 8000]
BAND_ABSORPTION = [0.10, 0.10, 0.11, 0.12, 0.13, 0.14, 0.14]
JOBS = [
    (walls, order, microphones)
    for walls in ("flat", "bands")
    for microphones in (1, 8)
    for order in (10, 17, 30)
]


def microphone_positions(count):
    return [[6.1 + 0.03 * i, 1.2, 4.3 - 0.05 * i] for i in range(count)]


def median_ms(work, repeats):
    times = []
    work()  # warms up
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return 1e3 * statistics.median(times)


class Earshot:
    name = "earshot"

    def __init__(self, program):
        self.program = program

    def ms(self, walls, order, microphones, repeats):
        command = [self.program, str(repeats), walls, str(order), str(microphones)]
        output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return float(output.splitlines()[-1].split()[-1])


class Pyroomacoustics:
    name = "pyroomacoustics"

    def __init__(self):
        import pyroomacoustics

        self.module = pyroomacoustics
        self.module.constants.set("num_threads", 1)

    def ms(self, walls, order, microphones, repeats):
        pra = self.module
        absorption = (
            {"coeffs": BAND_ABSORPTION, "center_freqs": BANDS_HZ}
            if walls == "bands"
            else ABSORPTION
        )

        def work():
            room = pra.ShoeBox(
                SIZE,
                fs=SAMPLE_RATE,
                materials=pra.Material(absorption),
                max_order=order,
                air_absorption=walls == "bands",
            )
            room.add_source(SOURCE)
            positions = list(zip(*microphone_positions(microphones)))
            room.add_microphone_array([list(axis) for axis in positions])
            room.image_source_model()
            room.compute_rir()

        return median_ms(work, repeats)


class TorchRir:
    name = "torchrir"

    def __init__(self):
        import torch
        import torchrir
        from torchrir.config import SimulationConfig
        from torchrir.sim import simulate

        torch.set_num_threads(1)
        self.torch, self.models = torch, torchrir
        self.config, self.simulate = SimulationConfig, simulate

    def ms(self, walls, order, microphones, repeats):
        if walls == "bands":
            return None  # knows one coefficient per wall
        tensor = self.torch.tensor
        scene = self.models.StaticScene(
            room=self.models.Room(
                size=tensor(SIZE), fs=SAMPLE_RATE, beta=tensor([(1.0 - ABSORPTION) ** 0.5] * 6)
            ),
            sources=self.models.Source(positions=tensor([SOURCE])),
            mics=self.models.MicrophoneArray(positions=tensor(microphone_positions(microphones))),
        )
        # As long as the last image of the order takes.
        config = self.config(max_order=order, tmax=(order + 1) * max(SIZE) / 343.0, device="cpu")
        return median_ms(lambda: self.simulate(scene, config), repeats)


def available_peers():
    peers = []
    for peer in (Pyroomacoustics, TorchRir):
        try:
            peers.append(peer())
        except ImportError:
            print(f"{peer.name}: not installed, left out", file=sys.stderr)
    return peers


def main():
    program, repeats = sys.argv[1], int(sys.argv[2])
    earshot, peers = Earshot(program), available_peers()
    heads = ["walls", "order", "microphones", "earshot, ms"]
    for peer in peers:
        heads += [f"{peer.name}, ms", "ratio"]
    print("| " + " | ".join(heads) + " |")
    print("| --- " + "| ---: " * (len(heads) - 1) + "|", flush=True)
    for walls, order, microphones in JOBS:
        own = earshot.ms(walls, order, microphones, repeats)
        cells = [walls, str(order), str(microphones), f"{own:.2f}"]
        for peer in peers:
            found = peer.ms(walls, order, microphones, repeats)
            cells += ["", ""] if found is None else [f"{found:.1f}", f"{found / own:.1f}"]
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
