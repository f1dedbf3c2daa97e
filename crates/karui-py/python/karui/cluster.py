"""Plans on many machines, through Ray.

    karui.cluster.run("work/", ray_address="auto")

A plan is a sequence of phases, each a bag of tasks that do not need each other. A task is a row
of the phase's manifest: what it reads, what it makes. It reads and writes the plan's store and
nothing else, and run twice, anywhere, it makes the same bytes. So meshes never travel through
Ray, only row numbers out and small results back, and it does not matter who dies on the way: what
is missing is run again, and a driver that has died is started again and goes on from the blocks
that are there and whole.

Every node needs this package, in the same version, and the same store and input under the same
paths. `ray` is imported when it is needed: `pip install "karui[cluster]"`.
"""

from __future__ import annotations

import heapq
import os
import platform
import threading
import time
import uuid
from collections import deque
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Callable, Iterator, Protocol

from . import __version__
from .errors import Cancelled, InputError, KaruiError

__all__ = ["ClusterError", "Report", "Task", "Work", "run"]


class ClusterError(KaruiError):
    """A plan could not be finished; all finished blocks stay, and `run` goes on from there."""


class Work(Protocol):
    """What `run` needs of a plan; `karui.Plan` has it."""

    @property
    def store(self) -> str | os.PathLike[str]:
        """Where everything is kept: a path that is the same on every node."""

    @classmethod
    def open(cls, store: str | os.PathLike[str]) -> Work:
        """The plan of a store; called once in every worker process."""

    def next(self) -> tuple[str, int] | None:
        """Name and number of rows of the phase to be run; None if all is done."""

    def run_task(self, phase: str, row: int) -> dict[str, Any]:
        """Runs a row: {"id": row, ...}, the same each time."""

    def verify_task(self, phase: str, row: int) -> dict[str, Any] | None:
        """The result of a row whose output is there and whole; None if it is to be run."""

    def commit(self, phase: str, results: list[dict[str, Any]]) -> None:
        """Closes a phase."""


@dataclass(frozen=True)
class Task:
    """A row that was run, where, and what it took."""

    phase: str
    row: int
    #: Seconds of processor time of the process that ran it.
    cpu: float
    #: Seconds from start to end there.
    wall: float
    #: Whether its output was there already.
    found: bool
    #: Process and node that ran it.
    process: int
    node: str


@dataclass
class Report:
    """What a run did. Only times depend on the machines."""

    #: Every row once, phase after phase.
    tasks: list[Task] = field(default_factory=list)
    #: Rows sent out again, because what they were sent to died, hung, or answered wrongly.
    resubmitted: int = 0
    #: Outputs that were answered for, but not there or not whole when they were verified.
    rebuilt: int = 0
    #: Seconds in all.
    seconds: float = 0.0

    @property
    def cpu(self) -> float:
        """Seconds of processor time of all tasks."""
        return sum(task.cpu for task in self.tasks)

    def makespan(self, workers: int) -> float:
        """Seconds that so many workers like those of the run would take at least by these tasks'
        processor times: each phase's rows in order to whoever is free first, a barrier between
        phases. Says nothing of what sending, reading and writing at once would cost."""
        phases: dict[str, list[float]] = {}
        for task in self.tasks:
            phases.setdefault(task.phase, []).append(task.cpu)
        return sum(_last_to_end(times, workers) for times in phases.values())


def _last_to_end(times: list[float], workers: int) -> float:
    busy = [0.0] * max(1, workers)
    for time_taken in times:
        heapq.heapreplace(busy, busy[0] + time_taken)
    return max(busy)


def run(
    plan: Work | str | os.PathLike[str],
    ray_address: str | None = None,
    *,
    wave: int = 2000,
    cpus: int = 1,
    memory: int | None = None,
    timeout: float = 1800.0,
    attempts: int = 10,
    progress: Callable[[str, float], Any] | None = None,
) -> Report:
    """Does all of a plan that is not done yet, on Ray.

    plan: a `karui.Plan`, or the path of its store. ray_address: as of `ray.init`: "auto",
    "host:port" or "ray://host:port"; "local" starts one here; None takes the Ray that is connected,
    or that runs on this machine, or else starts one.
    wave: rows sent out at the same time at most. cpus: processors, and threads, of a task. memory:
    bytes that a task may need, for Ray to place it by. timeout: seconds that a row may take; then
    its process ends itself, and the row is sent again. attempts: times a row is sent out at most. progress: called with a phase and a share of its rows; returning
    False cancels.

    Rows come back in any order; each must come back with its own number, and what it has made is
    verified by another task before the phase is closed. What is missing or wrong is run again.
    The blocks are the same as with `Plan.run`, whatever happens on the way.

    Raises ClusterError if a row fails for good, if Ray goes away or no row comes back for twice
    the timeout, Cancelled, and KeyboardInterrupt; called again, it goes on from there. Rows that
    are out then are left to end, unless Ray was started here.
    """
    ray = _ray()
    if isinstance(plan, (str, os.PathLike)):
        from . import Plan

        plan = Plan.open(plan)
    driver = _Driver(ray, plan, wave, cpus, memory, timeout, attempts, progress)
    mine = not ray.is_initialized()
    started = time.monotonic()
    try:
        if mine:
            ray.init(address=ray_address, log_to_driver=False)
        driver.run()
    except (ray.exceptions.RayError, ConnectionError) as error:
        raise ClusterError(f"Ray is not there, or not any more: {error}") from error
    finally:
        if mine:
            ray.shutdown()
    driver.report.seconds = time.monotonic() - started
    return driver.report


def _ray() -> Any:
    try:
        import ray
    except ImportError as error:
        raise ClusterError(
            "karui.cluster needs Ray on this machine and on every node: "
            'pip install "karui[cluster]" (or pip install ray)'
        ) from error
    return ray


#: The plan that a worker process has open, by the name of the run.
_plans: dict[str, Work] = {}


@dataclass(frozen=True)
class _Job:
    """What workers are told of a run."""

    kind: type[Work]
    store: str | os.PathLike[str]
    run: str
    timeout: float

    @contextmanager
    def opened(self) -> Iterator[Work]:
        """The plan, opened once a process and run. What takes too long ends its process: Ray then
        says so, and its place is free again. (Ray's own way to stop a task, `ray.cancel`, can
        end the driver if it comes just when the task does: seen in Ray 2.60.)"""
        if self.run not in _plans:
            _plans.clear()
            _plans[self.run] = self.kind.open(self.store)
        watchdog = threading.Timer(self.timeout, os._exit, (1,))
        watchdog.daemon = True
        watchdog.start()
        try:
            yield _plans[self.run]
        finally:
            watchdog.cancel()


def _do(job: _Job, phase: str, row: int) -> dict[str, Any]:
    """Runs in a worker: a row, unless its output is there already."""
    with job.opened() as plan:
        wall, cpu = time.perf_counter(), time.process_time()
        result = plan.verify_task(phase, row)
        found = result is not None
        if result is None:
            result = plan.run_task(phase, row)
        return {
            "result": result,
            "version": __version__,
            "cpu": time.process_time() - cpu,
            "wall": time.perf_counter() - wall,
            "found": found,
            "process": os.getpid(),
            "node": platform.node(),
        }


def _verify(job: _Job, phase: str, rows: list[int]) -> list[Any]:
    """Runs in a worker: what the outputs of some rows are, None where one is not whole."""
    with job.opened() as plan:
        return [plan.verify_task(phase, row) for row in rows]


#: Rows that one task verifies.
_BATCH = 16
#: Times the timeout of a row after which nobody is there to run it.
_PATIENCE = 2
#: Seconds between looks at what has come back.
_TICK = 0.2


class _Driver:
    def __init__(self, ray, plan, wave, cpus, memory, timeout, attempts, progress):
        if wave < 1 or attempts < 1 or cpus < 1 or not timeout > 0:
            raise InputError("`wave`, `attempts`, `cpus` and `timeout` must be above 0")
        self.ray, self.plan, self.report = ray, plan, Report()
        self.wave, self.attempts, self.progress = wave, attempts, progress
        self.job = _Job(type(plan), plan.store, uuid.uuid4().hex, timeout)
        # What dies is sent again from here, where it is counted.
        options = {
            "num_cpus": cpus,
            "max_retries": 0,
            "runtime_env": {"env_vars": {"RAYON_NUM_THREADS": str(cpus)}},
        }
        if memory is not None:
            options["memory"] = memory
        self.do = ray.remote(**options)(_do)
        self.verify = ray.remote(**options)(_verify)

    def run(self) -> None:
        while (phase := self.plan.next()) is not None:
            self._phase(*phase)

    def _phase(self, phase: str, count: int) -> None:
        self._tell(phase, 0.0)
        missing = list(range(count))
        answers: dict[int, dict[str, Any]] = {}
        for _ in range(self.attempts):
            answers.update(self._run_rows(phase, count, missing))
            missing = self._wrong(phase, answers)
            if not missing:
                break
            self.report.rebuilt += len(missing)
        else:
            raise ClusterError(
                f"{phase}: the outputs of {len(missing)} of {count} rows, the first of row "
                f"{missing[0]}, are not whole after {self.attempts} attempts; do all nodes see "
                f"the same store {self.plan.store!r}?"
            )
        self.plan.commit(phase, [answers[row]["result"] for row in range(count)])
        self.report.tasks.extend(
            Task(phase, row, **{key: answers[row][key] for key in _TIMES})
            for row in range(count)
        )
        self._tell(phase, 1.0)

    def _run_rows(self, phase, count, rows):
        def send(row):
            return self.do.remote(self.job, phase, row)

        def check(row, answer):
            if answer["version"] != __version__:
                node, found = answer["node"], answer["version"]
                raise ClusterError(f"node {node} has karui {found}, not {__version__} as here")
            return answer["result"]["id"] == row

        told = count - len(rows)
        return self._bag(rows, send, check, lambda n: self._tell(phase, (told + n) / count))

    def _wrong(self, phase, answers):
        """Rows whose outputs are not what was answered."""
        rows = sorted(answers)
        batches = [tuple(rows[i : i + _BATCH]) for i in range(0, len(rows), _BATCH)]

        def send(batch):
            return self.verify.remote(self.job, phase, list(batch))

        found = self._bag(batches, send, lambda batch, found: len(found) == len(batch))
        return [
            row
            for batch in batches
            for row, result in zip(batch, found[batch])
            if result != answers[row]["result"]
        ]

    def _bag(self, items, send, check, tell=lambda n: None):
        """Sends all items out and collects an answer to each, whatever it takes."""
        waiting, pending, answers = deque(items), {}, {}
        sent = dict.fromkeys(items, 0)
        heard = time.monotonic()

        def again(item, why):
            if sent[item] >= self.attempts:
                raise ClusterError(f"row {item} failed {sent[item]} times, at last so: {why}")
            self.report.resubmitted += 1
            waiting.append(item)

        while waiting or pending:
            while waiting and len(pending) < self.wave:
                item = waiting.popleft()
                sent[item] += 1
                pending[send(item)] = item
            ready, _ = self.ray.wait(list(pending), num_returns=len(pending), timeout=_TICK)
            for ref in ready:
                item, (answer, why) = pending.pop(ref), self._answer(ref)
                if why is not None:
                    again(item, why)
                elif not check(item, answer):
                    again(item, f"its answer is of another row: {answer}")
                else:
                    answers[item] = answer
            tell(len(answers))
            if ready:
                heard = time.monotonic()
            elif time.monotonic() - heard > _PATIENCE * self.job.timeout:
                silence = _PATIENCE * self.job.timeout
                raise ClusterError(f"no row has come back for {silence:g} s: is anybody there?")
        return answers

    def _answer(self, ref):
        """What a task has returned and None, or None and why it has not."""
        try:
            return self.ray.get(ref), None
        except self.ray.exceptions.RayTaskError as error:
            if isinstance(error.cause, InputError):
                # It would be the same the next time.
                raise ClusterError(f"a task cannot be done: {error.cause}") from error
            return None, error.cause
        except self.ray.exceptions.RayError as error:
            return None, error

    def _tell(self, phase: str, share: float) -> None:
        if self.progress is None:
            return
        answer = self.progress(phase, share)
        if answer is not None and not answer:
            raise Cancelled("cancelled by the progress callback; call run again to go on")


_TIMES = ("cpu", "wall", "found", "process", "node")
