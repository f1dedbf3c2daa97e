"""Kills what runs a plan, at random moments, and compares what comes out with a quiet run here.

    python storm.py [--rounds 20] [--side 1400] [--seed 1]

Ray runs on this machine with 1, 2 and 4 worker nodes in turn; each round kills -9 the raylet of a
node, a process at work, or the driver (which is then started again), once it has begun.
"""

import argparse
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np  # noqa: E402
import psutil  # noqa: E402
import ray  # noqa: E402
from conftest import grid  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

import karui  # noqa: E402
import karui.cluster  # noqa: E402

NODES = (1, 2, 4)
DRIVER = """
import sys, time, karui.cluster
def tell(phase, share):
    print("phase", phase, share, flush=True)
report = karui.cluster.run(sys.argv[1], sys.argv[2], timeout=120, attempts=50, progress=tell)
cpu = sum(task.cpu for task in report.tasks)
print("report", len(report.tasks), report.resubmitted, report.rebuilt,
      f"{report.seconds:.1f} s, {cpu:.2f} s of processor time,",
      f"on 8 and 64 workers {report.makespan(8):.2f} and {report.makespan(64):.2f} s", flush=True)
"""


def model(folder, side):
    rough = lambda x, y: 0.1 * np.sin(30 * x) * np.cos(20 * y) + 0.001 * np.sin(991 * x * y)
    karui.write(folder / "hills.ply", grid(side, rough))
    return folder / "hills.ply"


def plan(store, ply, block):
    return karui.Plan.create(store, ply, ratio=0.1, block_triangles=block)


def digest(store):
    """Every block and manifest; what killed writers have left aside is neither."""
    files = sorted(p for p in Path(store).iterdir() if not p.name.startswith("~"))
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


class Storm:
    def __init__(self):
        self.cluster = Cluster(
            initialize_head=True,
            head_node_args={"num_cpus": 0, "include_dashboard": False},
        )
        self.nodes = []

    def have(self, count):
        """So many worker nodes with a processor each."""
        while len(self.nodes) > count:
            self.cluster.remove_node(self.nodes.pop(), allow_graceful=False)
        while len(self.nodes) < count:
            self.nodes.append(self.cluster.add_node(num_cpus=1))

    def driver(self, store):
        command = [sys.executable, "-c", DRIVER, str(store), self.cluster.address]
        return subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    def kill(self, what, driver):
        """Whether there was one to kill."""
        if what == "driver":
            driver.kill()
            return True
        node = random.choice(self.nodes)
        raylet = node.all_processes["raylet"][0].process.pid
        if what == "raylet":
            os.kill(raylet, signal.SIGKILL)
            # It is gone for good; another machine takes its place.
            self.nodes.remove(node)
            return True
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline and driver.poll() is None:
            for process in psutil.process_iter(["cmdline"]):
                name = " ".join(process.info["cmdline"] or [])
                if name.startswith(("ray::_do", "ray::_verify")):
                    process.kill()
                    return True
            time.sleep(0.01)
        return False

    def shut_down(self):
        self.cluster.shutdown()


def begun(driver):
    """Waits until something has come back; whether it has before the driver ended."""
    for line in driver.stdout:
        if line.startswith("phase") and not line.endswith(" 0.0\n"):
            return True
    return False


def one_round(storm, store, what, delay, count):
    """Runs a plan with one death on the way; how many drivers it took, and the last's report."""
    storm.have(count)
    driver, drivers, killed = storm.driver(store), 1, False
    if begun(driver):
        time.sleep(delay)
        killed = driver.poll() is None and storm.kill(what, driver)
        storm.have(count)
    while True:
        said, errors = driver.communicate(timeout=600)
        if driver.returncode == 0:
            reports = [line for line in said.splitlines() if line.startswith("report")]
            return drivers, killed, (reports or ["report lost"])[-1]
        if drivers == 5 or (what != "driver" and drivers > 1):
            raise AssertionError(f"the driver fails: {errors[-2000:]}")
        driver, drivers = storm.driver(store), drivers + 1


def storm(rounds, side, block, longest, folder, tell=print):
    """Rounds whose bytes were others than those of a quiet run here."""
    ply, wrong = model(folder, side), 0
    quiet = plan(folder / "quiet", ply, block)
    quiet.run()
    expected = digest(quiet.store)
    tell(f"{2 * (side - 1) ** 2:,} triangles, {len(expected)} files in the store")
    weather = Storm()
    try:
        for number in range(rounds):
            what, count = ("raylet", "worker", "driver")[number % 3], random.choice(NODES)
            store, delay = folder / f"round-{number}", random.uniform(0, longest)
            plan(store, ply, block)
            drivers, killed, report = one_round(weather, store, what, delay, count)
            same = digest(store) == expected and karui.Plan.open(store).verify() == []
            wrong += not same
            tell(
                f"{number:2}: {count} nodes, {what} {'killed' if killed else 'not met'} after "
                f"{delay:.2f} s, {drivers} drivers, {report}: "
                f"{'same bytes' if same else 'OTHER BYTES'}",
                flush=True,
            )
            shutil.rmtree(store)
    finally:
        weather.shut_down()
    return wrong


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=20)
    options.add_argument("--side", type=int, default=1400)
    options.add_argument("--block", type=int, default=40_000)
    options.add_argument("--longest", type=float, default=4.0)
    options.add_argument("--seed", type=int, default=1)
    args = options.parse_args()
    random.seed(args.seed)
    with tempfile.TemporaryDirectory() as folder:
        wrong = storm(args.rounds, args.side, args.block, args.longest, Path(folder))
    print(f"{args.rounds - wrong} of {args.rounds} rounds gave the same bytes")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
