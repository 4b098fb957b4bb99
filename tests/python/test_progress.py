# SPDX-License-Identifier: MIT
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import earshot as es


def test_function_is_told_stages(room):
    told = []
    es.simulate(room, order=2, rays=2000, progress=lambda *call: told.append(call))
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    assert stages[0] == "tracing" and stages[-1] == "responses"
    assert all(0 <= done <= total for _, done, total in told)


def test_false_cancels_and_exceptions_pass_through(room):
    with pytest.raises(es.Cancelled):
        es.simulate(room, rays=100000, rays_error=0.0, progress=lambda *_: False)

    class Odd(Exception):
        pass

    def fail(*_):
        raise Odd

    with pytest.raises(Odd):
        es.simulate(room, rays=100000, progress=fail)
    assert es.simulate(room, order=1, rays=0, length=0.1).ir.any()  # the scene is as before


def test_bars_of_tqdms_kind(room):
    bars = []

    class Bar:
        def __init__(self, total, desc):
            self.total, self.desc, self.n, self.closed = total, desc, 0, False
            bars.append(self)

        def update(self, steps):
            self.n += steps

        def close(self):
            self.closed = True

    es.simulate(room, order=2, rays=2000, progress=Bar)
    assert [bar.desc for bar in bars][0] == "tracing"
    assert all(bar.closed and bar.n <= bar.total for bar in bars)


def test_line_on_standard_error(room, capfd):
    es.simulate(room, order=1, rays=500, progress=True)
    shown = capfd.readouterr().err
    assert "\rtracing" in shown and "responses 100 %" in shown and shown.endswith("\n")


def test_progress_in_another_thread(room):
    told = []
    thread = threading.Thread(
        target=lambda: es.simulate(room, order=1, rays=500, progress=lambda *c: told.append(c)))
    thread.start()
    thread.join()
    assert told


def test_control_c_stops_the_work():
    program = textwrap.dedent("""
        import earshot as es, sys
        room = es.shoebox((20, 8, 30), absorption=0.02)
        room.add_source("s", (1, 1, 1)); room.add_listener("l", (18, 2, 25))
        print("begin", flush=True)
        try:
            es.simulate(room, order=0, rays=500_000_000, rays_error=0.0)
        except KeyboardInterrupt:
            print("stopped", flush=True)
        print(es.simulate(room, order=1, rays=0, length=0.1).ir.shape, flush=True)
    """)
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True,
                             env=os.environ)
    assert child.stdout.readline() == "begin\n"
    time.sleep(0.5)
    begin = time.monotonic()
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "stopped\n"
    assert child.stdout.readline() == "(1, 1, 1, 4800)\n"
    assert child.wait(60) == 0 and time.monotonic() - begin < 30


def test_other_threads_run_meanwhile(room):
    """The interpreter's lock is free during work: a thread that counts goes on counting."""
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.monotonic()
    es.simulate(room, order=3, rays=20000, rays_error=0.0, threads=1)
    seconds, steps = time.monotonic() - begin, counted[0]
    done.set()
    thread.join()
    assert steps >= min(5.0, 20 * seconds)
