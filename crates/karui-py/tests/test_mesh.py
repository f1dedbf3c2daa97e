"""Arrays in and out."""

import gc
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import grid

import karui


def quad(**more):
    return karui.Mesh.from_arrays(*grid(2), **more)


def test_arrays_come_back_as_they_went_in(hills):
    positions, triangles = hills
    mesh = karui.Mesh.from_arrays(positions, triangles)
    assert mesh.positions.dtype == np.float32 and mesh.triangles.dtype == np.uint32
    assert np.array_equal(mesh.positions, positions)
    assert np.array_equal(mesh.triangles, triangles)
    assert np.array_equal(mesh.bounds, [positions.min(0), positions.max(0)])
    assert (mesh.normals, mesh.uvs, mesh.colors) == (None, None, None)
    assert mesh.attributes == {} and mesh.face_attributes == {}


@pytest.mark.parametrize("integer", ["u1", "i4", "<i8", ">i8", ">u4", "u8"])
def test_any_integers_and_layouts_are_taken(integer):
    positions, triangles = grid(2)
    odd = np.asfortranarray(positions.astype(">f8"))
    mesh = karui.Mesh.from_arrays(odd, np.repeat(triangles, 2, 0)[::2].astype(integer))
    assert np.array_equal(mesh.positions, positions)
    assert np.array_equal(mesh.triangles, triangles)
    lists = karui.Mesh.from_arrays(positions.tolist(), triangles.tolist())
    assert np.array_equal(lists.triangles, triangles)


def test_arrays_are_the_mesh_s_memory_and_cannot_be_written():
    mesh = quad(normals=[[0, 0, 1]] * 4)
    for get in (lambda: mesh.positions, lambda: mesh.triangles, lambda: mesh.normals):
        assert np.shares_memory(get(), get())
        with pytest.raises(ValueError):
            get()[0] = 7
        with pytest.raises(ValueError):
            get().flags.writeable = True


def test_arrays_outlive_their_mesh(hills):
    mesh = karui.Mesh.from_arrays(*hills)
    kept = mesh.positions[::2], mesh.triangles
    del mesh
    gc.collect()
    # Whatever is freed is written over.
    other = [np.full_like(hills[0], 9) for _ in range(20)]
    assert len(other) == 20
    assert np.array_equal(kept[0], hills[0][::2])
    assert np.array_equal(kept[1], hills[1])


def test_what_goes_in_is_copied():
    positions, triangles = grid(2)
    mesh = karui.Mesh.from_arrays(positions, triangles)
    positions[:], triangles[:] = 5, 0
    assert mesh.positions.max() == 1 and mesh.triangles.max() == 3


TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8"]


def test_attributes_by_name(tmp_path):
    uvs = np.linspace(0, 1, 8).reshape(4, 2).astype(np.float32)
    colors = np.linspace(0, 1, 16).reshape(4, 4).astype(np.float32)
    custom = {f"of_{t}": np.arange(4).astype(t) for t in TYPES}
    custom["wide"] = np.arange(12, dtype=np.float64).reshape(4, 3)
    given = {"TANGENT": [[1, 0, 0, 1]] * 4, "TEXCOORD_1": uvs + 1, **custom}
    faces = {"region": np.array([3, 4], np.int32)}
    mesh = quad(
        normals=[[0, 0, 1]] * 4,
        uvs=uvs,
        colors=colors,
        attributes=given,
        face_attributes=faces,
    )
    found = mesh.attributes
    usual = ["NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"]
    assert list(found) == usual + list(custom)
    assert np.array_equal(mesh.uvs, uvs) and np.array_equal(mesh.colors, colors)
    assert np.array_equal(found["TEXCOORD_1"], uvs + 1)
    for name, values in custom.items():
        assert found[name].dtype == values.dtype
        assert np.array_equal(found[name], values)
        assert not found[name].flags.writeable
    assert np.array_equal(mesh.face_attributes["region"], [3, 4])
    mesh.write(tmp_path / "quad.ply")
    back = karui.Mesh.read(tmp_path / "quad.ply")
    assert np.array_equal(back.attributes["of_i2"], custom["of_i2"])
    assert np.array_equal(back.face_attributes["region"], [3, 4])


def test_skins_come_from_files_only():
    with pytest.raises(karui.InputError, match="skins"):
        quad(attributes={"JOINTS_0": np.zeros((4, 4), np.uint16)})


def test_an_empty_mesh_is_a_mesh():
    mesh = karui.Mesh.from_arrays(np.zeros((0, 3)), np.zeros((0, 3), int))
    assert mesh.positions.shape == (0, 3) and mesh.triangles.shape == (0, 3)
    assert karui.simplify(mesh, ratio=0.5).mesh.triangles.shape == (0, 3)
    assert karui.saliency(mesh).shape == (0,)
    for needs_triangles in (karui.lod, lambda m: karui.measure(m, m)):
        with pytest.raises(karui.InputError, match="empty"):
            needs_triangles(mesh)


P, T = grid(2)
BAD = {
    "nan": (P * np.nan, T),
    "too large for 32 bits": (P.astype(float) * 1e300, T),
    "two columns": (P[:, :2], T),
    "flat": (P.ravel(), T),
    "scalar": (3.0, T),
    "none": (None, T),
    "text": (P.astype(str), T),
    "complex": (P * 1j, T),
    "ragged": ([[0, 0, 0], [1, 1]], T),
    "quads": (P, [[0, 1, 2, 3]]),
    "float triangles": (P, T.astype(float)),
    "negative": (P, T.astype(int) - 1),
    "negative 32": (P, T.astype(np.int32) - 1),
    "beyond the end": (P, T + 1),
    "wraps": (P, T.astype(np.int64) + 2**32),
    "wraps 64": (P, T.astype(np.uint64) + np.uint64(2**63)),
}


@pytest.mark.filterwarnings("ignore:overflow")
@pytest.mark.parametrize("name", BAD)
def test_bad_arrays_are_refused(name):
    with pytest.raises(karui.InputError):
        karui.Mesh.from_arrays(*BAD[name])
    with pytest.raises(ValueError):
        karui.simplify(BAD[name], ratio=0.5)


@pytest.mark.parametrize(
    "more",
    [
        {"normals": [[0, 0, 1]]},
        {"normals": [[0, 0, np.inf]] * 4},
        {"uvs": np.zeros((4, 3))},
        {"colors": np.zeros((4, 3))},
        {"attributes": {"TEXCOORD_1": np.zeros((4, 2))}},
        {"attributes": {"a": np.zeros(5, np.float32)}},
        {"attributes": {"a": np.zeros(4, np.int64)}},
        {"attributes": {"a": np.zeros((4, 0), np.float32)}},
        {"attributes": {"a": np.zeros((2, 2, 2), np.float32)}},
        {"face_attributes": {"a": np.zeros(4, np.float32)}},
    ],
)
def test_bad_attributes_are_refused(more):
    with pytest.raises(karui.InputError):
        quad(**more)


def test_meshes_of_others_are_taken():
    positions, triangles = grid(30)
    of_trimesh = SimpleNamespace(vertices=positions, faces=triangles)
    of_pyvista = SimpleNamespace(points=positions, regular_faces=triangles)
    pair = (positions, triangles)
    results = [karui.simplify(m, ratio=0.1) for m in (of_trimesh, of_pyvista, pair)]
    for result in results:
        assert np.array_equal(result.mesh.positions, results[0].mesh.positions)
    for other in (7, "mesh", (1, 2, 3), SimpleNamespace(vertices=positions)):
        with pytest.raises(karui.InputError, match="karui.Mesh"):
            karui.simplify(other)
