"""Cuts by view and by light."""

import numpy as np
import pytest

import karui


@pytest.fixture(scope="module")
def hierarchy(hills):
    return karui.Hierarchy.build(hills)


def sorted_rows(triangles):
    """Each triangle turned so that its least corner is first, all in order."""
    first = triangles.argmin(axis=1)
    turned = np.stack([np.roll(t, -f) for t, f in zip(triangles, first)])
    return turned[np.lexsort(turned.T[::-1])]


def test_the_finest_cut_is_the_mesh(hierarchy, hills):
    assert hierarchy.triangle_count == len(hills[1])
    assert np.array_equal(sorted_rows(hierarchy.finest().indices), sorted_rows(hills[1]))
    assert len(hierarchy.coarsest().indices) == hierarchy.coarsest_triangle_count
    assert hierarchy.coarsest_triangle_count < len(hills[1]) / 5
    assert hierarchy.is_of(hills) and not hierarchy.is_of((hills[0] * 2, hills[1]))


def test_any_path_leads_to_the_same_cut(hierarchy, hills):
    near = karui.Camera((0.2, 0.2, 0.3), (0.5, 0.5, 0))
    far = karui.Camera((0.5, 0.5, 20), (0.5, 0.5, 0))
    one, other = hierarchy.coarsest(), hierarchy.finest()
    one.refine(near)
    other.refine(far)
    change = other.refine(near)
    assert change.triangles == len(one.indices) == len(other.indices)
    assert np.array_equal(sorted_rows(one.indices), sorted_rows(other.indices))
    assert change.splits > 0 and change.ranges
    again = other.refine(near)
    assert (again.splits, again.collapses, again.ranges) == (0, 0, [])
    assert len(one.indices) > len(hierarchy.finest().indices) / 100


def test_ranges_tell_what_is_new(hierarchy):
    cut = hierarchy.coarsest()
    shown = cut.indices.copy()
    for height in (3, 1, 0.4, 2):
        change = cut.refine(karui.Camera((0.5, 0.4, height), (0.5, 0.5, 0)))
        buffer = np.resize(shown, (change.triangles, 3))
        for first, end in change.ranges:
            buffer[first:end] = cut.indices[first:end]
        assert np.array_equal(buffer, cut.indices)
        shown = buffer


def test_a_budget_is_kept(hierarchy):
    cut = hierarchy.coarsest()
    camera = karui.Camera((0.5, 0.5, 0.5), (0.5, 0.5, 0))
    free = cut.refine(camera, area=0, flatness=0).triangles
    change = cut.refine(camera, area=0, flatness=0, triangles=free // 2)
    assert change.triangles <= free // 2 and change.floor > 0


def test_lights_keep_more(hierarchy):
    camera = karui.Camera((0.5, 0.5, 3), (0.5, 0.5, 0))
    dark = hierarchy.coarsest().refine(camera, area=400).triangles
    lit = hierarchy.coarsest().refine(camera, area=400, lights=[(0, 0, -1)]).triangles
    assert lit > dark


def test_a_cut_becomes_a_mesh(hierarchy, hills):
    cut = hierarchy.coarsest()
    mesh = cut.to_mesh(hills)
    assert len(mesh.triangles) == len(cut.indices)
    assert len(mesh.positions) == len(np.unique(cut.indices))
    with pytest.raises(karui.InputError):
        cut.to_mesh((hills[0][:3], [[0, 1, 2]]))


def test_saved_and_loaded(hierarchy, hills, tmp_path):
    path = tmp_path / "hills.karui"
    hierarchy.save(path)
    loaded = karui.Hierarchy.load(path)
    assert loaded.is_of(hills) and [p.name for p in tmp_path.iterdir()] == ["hills.karui"]
    assert np.array_equal(loaded.coarsest().indices, hierarchy.coarsest().indices)
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(karui.InputError, match="byte"):
        karui.Hierarchy.load(path)
    for action in (karui.Hierarchy.load, hierarchy.save):
        with pytest.raises(karui.FileError):
            action(tmp_path / "none" / "x.karui")


def test_bad_options_are_refused(hierarchy, hills):
    for bad in ({"alpha": 0}, {"weights": [1.0]}, {"locks": [True]}):
        with pytest.raises(karui.InputError):
            karui.Hierarchy.build(hills, **bad)
    camera = karui.Camera((0, 0, 0), (0, 0, 0))
    with pytest.raises(karui.InputError):
        hierarchy.coarsest().refine(camera)
