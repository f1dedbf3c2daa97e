"""The driver: whoever dies, the same bytes."""

import sys
from pathlib import Path

import pytest
from fake_work import PHASES, FakeWork

import karui
import karui.cluster

ROWS = sum(PHASES)


@pytest.fixture(scope="module")
def ray():
    ray = pytest.importorskip("ray")
    path = {"env_vars": {"PYTHONPATH": str(Path(__file__).parent)}}
    ray.init("local", num_cpus=2, include_dashboard=False, log_to_driver=False, runtime_env=path)
    yield ray
    ray.shutdown()


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    work = FakeWork.create(tmp_path_factory.mktemp("here") / "work")
    work.run()
    return work.bytes()


def test_where_there_is_no_ray_it_says_so(tmp_path, monkeypatch):
    ray = pytest.importorskip("ray")

    def refuse(**_):
        raise ConnectionError("no such cluster")

    monkeypatch.setattr(ray, "init", refuse)
    with pytest.raises(karui.cluster.ClusterError, match="not there"):
        karui.cluster.run(FakeWork.create(tmp_path / "work"), "127.0.0.1:1")


def test_a_plan_is_run(ray, tmp_path, expected):
    told = []
    work = FakeWork.create(tmp_path / "work")
    report = karui.cluster.run(work, progress=lambda *told_now: told.append(told_now))
    assert work.bytes() == expected
    assert [(task.phase, task.row) for task in report.tasks] == [
        (str(phase), row) for phase, rows in enumerate(PHASES) for row in range(rows)
    ]
    assert report.resubmitted == report.rebuilt == 0
    for phase in "012":
        shares = [share for name, share in told if name == phase]
        assert shares[0] == 0 and shares[-1] == 1 and shares == sorted(shares)


TROUBLES = {
    "killed": ["killed"],
    "killed twice in a phase": ["killed", "killed"],
    "raises": ["raises"],
    "unwritten": ["unwritten"],
    "half-written": ["half-written"],
    "other row": ["other row"],
    "all": ["killed", "raises", "unwritten", "half-written", "other row"],
}


@pytest.mark.parametrize("name", TROUBLES)
def test_troubles_change_nothing(ray, tmp_path, expected, name):
    troubles = [(phase, k, what) for k, what in enumerate(TROUBLES[name]) for phase in (0, 1)]
    work = FakeWork.create(tmp_path / "work", troubles)
    report = karui.cluster.run(work)
    assert work.bytes() == expected
    assert not list(work.root.glob("trouble*"))
    assert report.resubmitted + report.rebuilt >= len(troubles)


def test_what_hangs_is_sent_again(ray, tmp_path, expected):
    work = FakeWork.create(tmp_path / "work", [(0, 3, "hangs"), (2, 0, "hangs")])
    report = karui.cluster.run(work, timeout=5)
    assert work.bytes() == expected
    assert report.resubmitted >= 2


def test_where_nobody_is_it_says_so(ray, tmp_path):
    work = FakeWork.create(tmp_path / "work")
    with pytest.raises(karui.cluster.ClusterError, match="anybody"):
        karui.cluster.run(work, cpus=64, timeout=1)


def test_small_waves_do_the_same(ray, tmp_path, expected):
    work = FakeWork.create(tmp_path / "work")
    karui.cluster.run(work, wave=1)
    assert work.bytes() == expected


def test_what_cannot_be_done_is_said_at_once(ray, tmp_path, expected):
    work = FakeWork.create(tmp_path / "work", [(1, 2, "never")])
    with pytest.raises(karui.cluster.ClusterError, match="vertex that does not exist"):
        karui.cluster.run(work)
    next(work.root.glob("trouble*")).unlink()
    before = {p.name: p.stat().st_mtime_ns for p in work.root.glob("0-*.out")}
    report = karui.cluster.run(work)
    assert work.bytes() == expected
    assert {p.name: p.stat().st_mtime_ns for p in work.root.glob("0-*.out")} == before
    assert len(report.tasks) < ROWS


def test_attempts_are_counted(ray, tmp_path):
    work = FakeWork.create(tmp_path / "work", [(0, 0, "raises")])
    with pytest.raises(karui.cluster.ClusterError, match="no space left"):
        karui.cluster.run(work, attempts=1)


def test_false_cancels_and_run_goes_on(ray, tmp_path, expected):
    work = FakeWork.create(tmp_path / "work")
    with pytest.raises(karui.Cancelled):
        karui.cluster.run(work, progress=lambda phase, share: phase != "1")
    assert (work.root / "0.done").exists() and not (work.root / "1.done").exists()
    karui.cluster.run(work)
    assert work.bytes() == expected
    assert karui.cluster.run(work).tasks == []


def test_damage_found_later_is_not_taken_for_done(ray, tmp_path, expected):
    work = FakeWork.create(tmp_path / "work", [(1, 2, "never")])
    with pytest.raises(karui.cluster.ClusterError):
        karui.cluster.run(work)
    next(work.root.glob("trouble*")).unlink()
    for found in list(work.root.glob("1-*.out"))[:1]:
        found.write_text("{")
    karui.cluster.run(work)
    assert work.bytes() == expected


def test_bad_options_are_refused(ray, tmp_path):
    work = FakeWork.create(tmp_path / "work")
    for bad in ({"wave": 0}, {"attempts": 0}, {"cpus": 0}, {"timeout": 0}):
        with pytest.raises(karui.InputError):
            karui.cluster.run(work, **bad)


def test_makespan_is_that_of_the_longest():
    tasks = [("a", 3.0), ("a", 1.0), ("a", 2.0), ("b", 5.0)]
    report = karui.cluster.Report(
        [karui.cluster.Task(p, i, t, t, False, 1, "n") for i, (p, t) in enumerate(tasks)]
    )
    assert report.cpu == 11
    # Phase a on two: 3 | 1 + 2; then b.
    assert [report.makespan(n) for n in (1, 2, 3, 100)] == [11, 8, 8, 8]


def test_without_ray_it_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(karui.cluster.ClusterError, match="pip install"):
        karui.cluster.run(FakeWork.create(tmp_path / "work"))
