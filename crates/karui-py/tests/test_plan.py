"""Models larger than memory."""

import random

import numpy as np
import pytest
from conftest import grid
from storm import digest

import karui


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "hills.ply"
    rough = lambda x, y: 0.1 * np.sin(9 * x) * np.cos(7 * y) + 0.001 * np.sin(991 * x * y)
    karui.write(path, grid(250, rough))
    return path


def plan(store, model, **options):
    return karui.Plan.create(store, model, ratio=0.1, block_triangles=20_000, **options)


@pytest.fixture(scope="module")
def expected(model, tmp_path_factory):
    here = plan(tmp_path_factory.mktemp("here") / "store", model)
    told = []
    here.run(progress=lambda *now: told.append(now))
    assert here.next() is None and here.verify() == []
    assert all(0 <= share <= 1 for _, share in told)
    return digest(here.store)


def by_hand(work, last=""):
    """Runs phases row by row, in any order, up to the one whose name ends so."""
    while (phase := work.next()) is not None:
        name, rows = phase
        order = random.sample(range(rows), rows)
        assert [work.verify_task(name, row) for row in order] == [None] * rows
        results = [work.run_task(name, row) for row in order]
        for row, result in list(zip(order, results))[:2]:
            assert work.run_task(name, row) == work.verify_task(name, row) == result
        assert work.next() == phase
        work.commit(name, results)
        if last and name.endswith(last):
            break


def test_tasks_one_by_one_in_any_order(model, tmp_path, expected):
    random.seed(3)
    work = plan(tmp_path / "store", model)
    by_hand(work)
    assert digest(work.store) == expected


def test_the_result_is_a_mesh(model, tmp_path):
    work = plan(tmp_path / "store", model)
    with pytest.raises(karui.InputError, match="not done"):
        work.write(tmp_path / "coarse.ply")
    work.run()
    summary = work.write(tmp_path / "coarse.ply")
    whole, coarse = karui.Mesh.read(model), karui.Mesh.read(tmp_path / "coarse.ply")
    assert summary.input == len(whole.triangles)
    assert summary.triangles == len(coarse.triangles)
    assert summary.vertices == len(coarse.positions)
    assert summary.triangles == pytest.approx(0.1 * summary.input, rel=0.01)
    at_once = karui.simplify(whole, triangles=summary.triangles).mesh
    rms = [karui.measure(whole, mesh, samples=100_000).rms for mesh in (coarse, at_once)]
    assert rms[0] < 1.5 * rms[1]
    # No cracks: every edge has two sides but for those of the square's rim.
    edges = np.sort(coarse.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    ends = coarse.positions[edges[counts == 1]]
    across = ends[..., :2]  # its corners have moved a little
    on_rim = (np.minimum(abs(across), abs(across - 1)) < 1e-3).any(axis=-1)
    assert on_rim.all() and counts.max() == 2
    for name in ("coarse.obj", "coarse.ply.gz"):
        with pytest.raises(karui.InputError):
            work.write(tmp_path / name)
    with pytest.raises(karui.FileError):
        work.write(tmp_path / "none" / "coarse.ply")
    with pytest.raises(karui.Cancelled):
        work.write(tmp_path / "other.ply", progress=lambda *_: False)
    assert not (tmp_path / "other.ply").exists()


def test_it_goes_on_from_where_it_was(model, tmp_path, expected):
    work = plan(tmp_path / "store", model)
    with pytest.raises(karui.Cancelled):
        work.run(progress=lambda phase, share: phase != "simplify")
    again = karui.Plan.open(work.store)
    assert again.model == str(model) and again.next() is not None
    again.run(memory_limit=1 << 30)
    assert digest(work.store) == expected


def test_what_is_damaged_is_found_and_made_anew(model, tmp_path, expected):
    work = plan(tmp_path / "store", model)
    by_hand(work, last="read")
    block = next(p for p in sorted(work.store.iterdir()) if "read" in p.name and p.suffix == ".block")
    flipped = bytearray(block.read_bytes())
    flipped[len(flipped) // 2] ^= 4
    block.write_bytes(flipped)
    assert work.verify() == [block.name]
    work.run()
    assert digest(work.store) == expected


def test_a_cluster_makes_the_same_bytes(model, tmp_path, expected):
    ray = pytest.importorskip("ray")
    import karui.cluster

    ray.init("local", num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        work = plan(tmp_path / "store", model)
        report = karui.cluster.run(str(work.store))
        assert digest(work.store) == expected
        assert report.cpu > 0 and report.makespan(1) == pytest.approx(report.cpu)
        assert {task.found for task in report.tasks} == {False}
        assert karui.cluster.run(work).tasks == []
    finally:
        ray.shutdown()


def test_bad_input_is_refused(model, tmp_path):
    with pytest.raises(karui.FileError, match="no such file"):
        karui.Plan.create(tmp_path / "a", tmp_path / "none.ply")
    with pytest.raises(karui.FileError):
        karui.Plan.open(tmp_path / "none")
    for bad in ({"ratio": 2}, {"error": -1}, {"block_triangles": 1}, {"scheme": "x"}):
        with pytest.raises(karui.InputError):
            karui.Plan.create(tmp_path / "a", model, **bad)
    work = plan(tmp_path / "b", model)
    with pytest.raises(karui.InputError, match="another plan"):
        karui.Plan.create(tmp_path / "b", model, ratio=0.2)
    name, rows = work.next()
    with pytest.raises(karui.InputError, match="no row"):
        work.run_task(name, rows)
    with pytest.raises(karui.InputError):
        work.commit(name, [{"id": 0}])
    with pytest.raises(karui.InputError, match="no result"):
        work.commit(name, [])
    with pytest.raises(karui.FileError):
        work.run_task("99-none", 0)
