"""A plan whose tasks are sums, with everything that can go wrong on the way.

Phase k has a row for each number; a row writes (the sum of what it reads + its number) to a file.
Troubles are files in the store: whoever comes first takes one away and is struck by it.
"""

import json
import os
import signal
import time
from pathlib import Path

from karui import FileError, InputError

PHASES = [12, 5, 1]


class FakeWork:
    def __init__(self, store):
        self.store = str(store)
        self.root = Path(store)

    @classmethod
    def create(cls, store, troubles=()):
        store.mkdir()
        (store / "plan.json").write_text("{}")
        for phase, row, trouble in troubles:
            (store / f"trouble-{phase}-{row}-{trouble}").touch()
        return cls(store)

    @classmethod
    def open(cls, store):
        if not (Path(store) / "plan.json").exists():
            raise FileError(f"{store}: no plan there")
        return cls(store)

    def next(self):
        for number, rows in enumerate(PHASES):
            if not (self.root / f"{number}.done").exists():
                return str(number), rows
        return None

    def output(self, phase, row):
        return self.root / f"{phase}-{row}.out"

    def _value(self, phase, row):
        if phase == 0:
            return row * row + 1
        inputs = range(row, PHASES[phase - 1], PHASES[phase])
        return row + sum(
            json.loads(self.output(phase - 1, i).read_text())["value"] for i in inputs
        )

    def run_task(self, phase, row):
        trouble = self._trouble(phase, row)
        result = {"id": row, "value": self._value(int(phase), row)}
        if trouble == "unwritten":
            return result
        if trouble == "half-written":
            self.output(phase, row).write_text("{")
            return result
        aside = self.root / f".{os.getpid()}.part"
        aside.write_text(json.dumps(result))
        aside.rename(self.output(phase, row))
        return {"id": row + 1, "value": 0} if trouble == "other row" else result

    def _trouble(self, phase, row):
        for path in self.root.glob(f"trouble-{phase}-{row}-*"):
            trouble = path.name.split("-", 3)[3]
            if trouble != "never":
                path.unlink()
            if trouble == "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            if trouble == "hangs":
                time.sleep(3600)
            if trouble == "raises":
                raise FileError("no space left on the device")
            if trouble == "never":
                raise InputError("a vertex that does not exist")
            return trouble
        return None

    def verify_task(self, phase, row):
        try:
            return json.loads(self.output(phase, row).read_text())
        except (OSError, ValueError):
            return None

    def commit(self, phase, results):
        assert [result["id"] for result in results] == list(range(PHASES[int(phase)]))
        (self.root / f"{phase}.done").write_text(json.dumps(results))

    def run(self):
        """Here, without anything else."""
        while (phase := self.next()) is not None:
            name, rows = phase
            self.commit(name, [self.run_task(name, row) for row in range(rows)])

    def bytes(self):
        """What is in the store but for troubles."""
        files = sorted(p for p in self.root.iterdir() if p.suffix in (".out", ".done"))
        return {p.name: p.read_bytes() for p in files}
