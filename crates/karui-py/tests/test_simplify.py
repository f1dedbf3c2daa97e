"""Simplification and levels, against closed forms."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import CLOTH, grid

import karui


def off_the_ball(mesh):
    """Largest distance of a vertex from the unit sphere."""
    return np.abs(np.linalg.norm(mesh.positions, axis=1) - 1).max()


@pytest.mark.parametrize("quality", ["fast", "balanced", "exact"])
def test_a_ball_stays_a_ball(ball, quality):
    result = karui.simplify(ball, ratio=0.1, quality=quality)
    count = len(result.mesh.triangles)
    assert result.stopped == "target"
    assert abs(count - len(ball[1]) / 10) <= 2
    assert off_the_ball(result.mesh) < 0.02
    # A closed surface of one part without handles: V - E + F = 2, E = 3/2 F.
    assert len(result.mesh.positions) - count // 2 == 2


def test_bounds(ball):
    few = karui.simplify(ball, triangles=100)
    assert len(few.mesh.triangles) == 100 and few.collapses > 0
    close = karui.simplify(ball, error=0.001)
    assert close.stopped == "error" and close.error <= 0.001
    both = karui.simplify(ball, triangles=100, relative_error=1e-4)
    assert both.stopped == "error" and len(both.mesh.triangles) > 100


def test_a_flat_square_needs_two_triangles():
    result = karui.simplify(grid(40), error=0.0)
    assert len(result.mesh.triangles) == 2
    area = np.linalg.norm(np.cross(*np.diff(result.mesh.positions[result.mesh.triangles], axis=1).swapaxes(0, 1)), axis=1).sum() / 2
    assert area == pytest.approx(1)


def test_locks_weights_and_borders(hills):
    positions, triangles = hills
    locks = np.zeros(len(positions), bool)
    locks[500:600] = True
    kept = karui.simplify(hills, ratio=0.05, locks=locks).mesh.positions
    there = {tuple(p) for p in kept}
    assert all(tuple(p) in there for p in positions[locks])
    weights = np.where(positions[:, 0] < 0.5, 1000, 1).astype(np.float32)
    kept = karui.simplify(hills, ratio=0.05, weights=weights).mesh.positions
    assert (kept[:, 0] < 0.5).mean() > 0.6
    kept = karui.simplify(hills, ratio=0.05, border="lock").mesh.positions
    assert (kept[:, 0] == 0).sum() == 200
    kept = karui.simplify(hills, ratio=0.1, placement="half_edge").mesh.positions
    there = {tuple(p) for p in positions}
    assert all(tuple(p) in there for p in kept)


@pytest.mark.parametrize(
    "options",
    [
        {"ratio": 2},
        {"ratio": -0.1},
        {"error": -1},
        {"error": float("nan")},
        {"quality": "best"},
        {"border": "x"},
        {"placement": "x"},
        {"weights": [1.0]},
        {"weights": np.full(40000, -1.0)},
        {"locks": [True]},
        {"locks": np.zeros(40000)},
        {"regularity": 1e9},
        {"attribute_weight": -1},
    ],
)
def test_bad_options_are_refused(hills, options):
    with pytest.raises(karui.InputError):
        karui.simplify(hills, **options)


def test_attributes_come_along():
    mesh = karui.Mesh.read(CLOTH)
    coarse = karui.simplify(mesh, ratio=0.1).mesh
    assert list(coarse.attributes) == list(mesh.attributes)
    assert len(coarse.uvs) == len(coarse.positions)


def test_levels_are_measured(ball):
    levels = karui.lod(ball, levels=3)
    counts = [len(level.mesh.triangles) for level in levels]
    halves = [len(ball[1]) / 2**k for k in (1, 2, 3)]
    assert np.allclose(counts, halves, atol=2)
    for level in levels:
        assert 0 < level.mean < level.rms < level.max <= level.error
        measured = karui.measure(ball, level.mesh)
        assert level.max == pytest.approx(measured.max, rel=0.2)
    assert [level.switch_distance for level in levels] == sorted(
        level.switch_distance for level in levels
    )
    # An error of a pixel at 1080 pixels and 60 degrees.
    expected = levels[0].error * 1080 / (2 * np.tan(np.pi / 6))
    assert levels[0].switch_distance == pytest.approx(expected)


def test_levels_by_what_is_asked(ball):
    by_ratio = karui.lod(ball, ratios=[0.5, 0.1])
    by_count = karui.lod(ball, triangles=[len(level.mesh.triangles) for level in by_ratio])
    for a, b in zip(by_ratio, by_count):
        assert np.array_equal(a.mesh.triangles, b.mesh.triangles)
    for level, asked in zip(karui.lod(ball, errors=[0.002, 0.01]), [0.002, 0.01]):
        assert level.max <= asked
    with pytest.raises(karui.InputError, match="at most one"):
        karui.lod(ball, ratios=[0.5], errors=[0.1])
    with pytest.raises(karui.InputError):
        karui.lod(ball, ratios=[2])


HASH = """
import sys, hashlib, karui, numpy as np
data = np.load(sys.argv[1])
mesh = karui.simplify((data["p"], data["t"]), ratio=0.1).mesh
print(hashlib.sha256(mesh.positions.tobytes() + mesh.triangles.tobytes()).hexdigest())
"""


def test_any_number_of_threads_gives_the_same_bytes(hills, tmp_path):
    file = tmp_path / "hills.npz"
    np.savez(file, p=hills[0], t=hills[1])
    hashes = {
        subprocess.check_output(
            [sys.executable, "-c", HASH, str(file)],
            env={**os.environ, "RAYON_NUM_THREADS": str(threads)},
        )
        for threads in (1, 2, 8)
    }
    mesh = karui.simplify(hills, ratio=0.1).mesh
    here = hashlib.sha256(mesh.positions.tobytes() + mesh.triangles.tobytes())
    assert hashes == {here.hexdigest().encode() + b"\n"}
