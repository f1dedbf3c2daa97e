"""Progress, cancellation, Ctrl-C, and the interpreter going on meanwhile."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from conftest import grid

import karui


@pytest.fixture(scope="module")
def large():
    return karui.Mesh.from_arrays(*grid(400, lambda x, y: 0.01 * (x * 997 % 1 + y * 991 % 1)))


def test_stages_and_fractions_are_told(large):
    told = []
    caller = threading.get_ident()

    def progress(stage, fraction):
        assert threading.get_ident() == caller
        told.append((stage, fraction))

    karui.simplify(large, ratio=0.1, progress=progress)
    assert len(told) > 2
    assert all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in told)


def test_false_cancels(large):
    started = time.monotonic()
    with pytest.raises(karui.Cancelled):
        karui.simplify(large, quality="exact", progress=lambda *_: False)
    assert time.monotonic() - started < 10
    with pytest.raises(karui.Cancelled):
        karui.Hierarchy.build(large, progress=lambda *_: False)
    with pytest.raises(karui.Cancelled):
        karui.measure(large, large, samples=50_000_000, progress=lambda *_: False)


def test_an_exception_of_the_callback_comes_through(large):
    def progress(stage, fraction):
        raise LookupError(stage)

    with pytest.raises(LookupError):
        karui.lod(large, progress=progress)
    with pytest.raises(TypeError):
        karui.lod(large, progress=7)


def test_other_threads_go_on(large):
    counted, done = 0, threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    started = time.monotonic()
    karui.simplify(large, ratio=0.1)
    took = time.monotonic() - started
    done.set()
    thread.join()
    assert counted > 100 * took


def test_several_threads_work_at_once(ball):
    results = []
    work = lambda: results.append(len(karui.simplify(ball, ratio=0.2).mesh.triangles))
    threads = [threading.Thread(target=work) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(results) == 4 and len(set(results)) == 1


INTERRUPTED = """
import sys, karui
sys.path.insert(0, sys.argv[1])
from conftest import grid
mesh = grid(400, lambda x, y: 0.01 * (x * 997 % 1 + y * 991 % 1))
print("ready", flush=True)
try:
    karui.simplify(mesh, quality="exact")
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.skipif(os.name == "nt", reason="SIGINT")
def test_ctrl_c_stops_the_work():
    here = os.path.dirname(__file__)
    child = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, here], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    started = time.monotonic()
    assert child.communicate(timeout=60)[0] == "interrupted\n"
    # To the end it would take minutes on a slow machine, seconds on a fast one.
    assert time.monotonic() - started < 10
