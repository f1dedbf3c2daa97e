"""Surfaces of cages against closed forms."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import grid

import karui

SCHEMES = ["catmull-clark", "sqrt2", "sqrt3", "loop", "bilinear"]
CORNERS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
EDGES = [[a, b] for a in range(8) for b in range(a) if (a ^ b) in (1, 2, 4)]
OCTAHEDRON = (
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
)


def quad_grid(side, height=lambda x, y: 0.0 * x):
    """(side - 1)^2 quads over whole numbers."""
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    corner = np.arange(side * side).reshape(side, side)
    around = (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    positions = np.stack([x, y, height(x, y)], -1).reshape(-1, 3)
    return positions, np.stack([c.ravel() for c in around], 1)


def test_a_cube_becomes_round_as_far_as_the_masks_say():
    made = karui.subdivide((CORNERS, QUADS), 4, limit=True, normals=True)
    assert made.faces.shape == (6 * 4**4, 4) and len(made.positions) == 6 * 4**4 + 2
    radius = np.linalg.norm(made.positions, axis=1)
    # Halstead, Kass and DeRose: (n^2 v + 4 sum e + sum f) / n(n + 5), by hand.
    corner = (9 - 1 + 4) / 24 * np.sqrt(3)
    middle = (16 + 4 * (4 * 3 / 4) + 4 * 5 / 9) / 36
    assert radius.max() == pytest.approx(corner, abs=1e-6)
    assert radius.min() == pytest.approx(middle, abs=1e-6)
    assert made.positions[:8] == pytest.approx(CORNERS / 2, abs=1e-6)
    towards = np.einsum("ij,ij->i", made.normals, made.positions) / radius
    assert np.linalg.norm(made.normals, axis=1) == pytest.approx(1, abs=1e-5)
    assert towards.min() > 0.98


def test_one_step_of_a_cube_by_hand():
    made = karui.subdivide((CORNERS, QUADS))
    assert made.positions[:8] == pytest.approx(CORNERS * 5 / 9, abs=1e-6)
    assert np.sort(np.abs(made.positions[8:14]), 1) == pytest.approx(np.array([[0, 0, 1]] * 6))
    edges = np.array([[0, 0.75, 0.75]] * 12)
    assert np.sort(np.abs(made.positions[14:]), 1) == pytest.approx(edges)


@pytest.mark.parametrize("levels", [1, 3])
def test_a_parabola_of_splines_is_known(levels):
    cage = quad_grid(9, lambda x, y: x**2)
    made = karui.subdivide(cage, levels, limit=True)
    x, y, z = made.positions.T
    inside = (np.abs(x - 4) < 2.5) & (np.abs(y - 4) < 2.5)
    # Cubic B-splines over whole numbers have the variance 1/3.
    assert z[inside] == pytest.approx(x[inside] ** 2 + 1 / 3, abs=1e-4)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_is_flat_stays_flat(scheme):
    positions, faces = grid(7) if scheme in ("loop", "sqrt3") else quad_grid(7)
    # Of triangles, two of the square's corners have two and would become round.
    cage = karui.ControlMesh.from_arrays(positions, faces, corners=[0, 6, 42, 48])
    made = karui.subdivide(cage, 3, scheme)
    assert np.abs(made.positions[:, 2]).max() == 0
    edge = np.max(positions)
    assert made.positions[:, :2].min() >= 0 and made.positions[:, :2].max() <= edge
    mesh = made.to_mesh()
    a, b, c = (mesh.positions[mesh.triangles[:, i]].astype(float) for i in range(3))
    area = np.cross(b - a, c - a)[:, 2] / 2
    assert area.min() > 0 and area.sum() == pytest.approx(edge**2, rel=1e-5)


def test_loop_of_an_octahedron_by_hand():
    made = karui.subdivide(OCTAHEDRON, 2, "loop", limit=True)
    assert made.faces.shape == (8 * 16, 3)
    beta = (5 / 8 - (3 / 8 + np.cos(2 * np.pi / 4) / 4) ** 2) / 4
    chi = 1 / (3 / (8 * beta) + 4)
    poles = np.array(OCTAHEDRON[0]) * (1 - 4 * chi)  # the neighbours' sum is zero
    assert made.positions[:6] == pytest.approx(poles, abs=1e-6)


def test_sqrt3_of_an_octahedron_by_hand():
    made = karui.subdivide(OCTAHEDRON, 1, "sqrt3")
    positions, faces = (np.array(part) for part in OCTAHEDRON)
    share = (4 - 2 * np.cos(2 * np.pi / 4)) / 9
    assert made.faces.shape == (24, 3)
    assert made.positions[:6] == pytest.approx(positions * (1 - share), abs=1e-6)
    assert made.positions[6:] == pytest.approx(positions[faces].mean(1), abs=1e-6)


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_two_steps_of_sqrt2_are_one_of_catmull_clark(levels):
    cage = karui.ControlMesh.from_arrays(
        CORNERS, QUADS[:5], creases=EDGES[:3], crease_sharpness=1.5, corners=[7]
    )
    once = karui.subdivide(cage, levels)
    twice = karui.subdivide(cage, 2 * levels, "sqrt2")
    assert np.array_equal(once.positions, twice.positions)
    assert np.array_equal(once.indices, twice.indices)
    odd = karui.subdivide((CORNERS, QUADS), 1, "sqrt2")
    assert odd.faces.shape == (12, 4) and len(odd.positions) == 14


def test_sharp_edges_and_corners_stay():
    cage = karui.ControlMesh.from_arrays(CORNERS, QUADS, creases=EDGES)
    assert cage.creases.shape == (12, 2) and set(cage.crease_sharpness) == {10}
    made = karui.subdivide(cage, 3, limit=True)
    assert np.abs(made.positions).max(1) == pytest.approx(1)
    corner = karui.ControlMesh.from_arrays(CORNERS, QUADS, corners=[3], corner_sharpness=[10])
    made = karui.subdivide(corner, 3, limit=True)
    assert made.positions[3] == pytest.approx(CORNERS[3])
    assert made.positions[0] == pytest.approx(CORNERS[0] / 2, abs=0.05)
    assert karui.subdivide(cage, 2, "bilinear").positions[:8] == pytest.approx(CORNERS)


def test_holes_and_boundaries_leave_faces_out():
    holed = karui.ControlMesh.from_arrays(CORNERS, QUADS, holes=[0])
    whole = karui.subdivide((CORNERS, QUADS), 2)
    made = karui.subdivide(holed, 2)
    assert len(made.faces) == 5 * 16
    there = {tuple(p) for p in whole.positions}
    assert all(tuple(p) in there for p in made.positions)
    refinement = karui.Refinement(holed, 2)
    assert refinement.face_count == 96 and refinement.holes.sum() == 16
    assert set(refinement.parents[refinement.holes]) == {0}
    assert len(refinement.triangles) == 2 * 80
    sheet = quad_grid(5)
    faces = [len(karui.subdivide(sheet, 1, boundary=rule).faces) for rule in ("none", "corner")]
    assert faces == [4 * 4, 4 * 16]
    round_ = karui.subdivide(sheet, 3, boundary="edge", limit=True).positions
    square = karui.subdivide(sheet, 3, boundary="corner", limit=True).positions
    assert square[0].tolist() == [0, 0, 0] and round_[0].min() == 0 and round_[0].max() > 0.1


def test_faces_may_be_given_in_any_way():
    pentagon = np.array([[np.cos(t), np.sin(t), 0] for t in 2 * np.pi * np.arange(5) / 5])
    positions = np.concatenate([pentagon, [[2, 0, 0]]])
    ragged = [[0, 1, 2, 3, 4], (0, 5, 1)]
    flat, offsets = np.concatenate(ragged), [0, 5, 8]
    one = karui.subdivide((positions, ragged), 2)
    assert one.faces.shape == (8 * 4, 4)
    for cage in (
        (positions, [np.array(face) for face in ragged]),
        (positions, flat, offsets),
        karui.ControlMesh.from_arrays(positions, ragged),
        karui.ControlMesh.from_arrays(positions, flat.astype(np.int16), offsets),
    ):
        same = karui.subdivide(cage, 2)
        assert np.array_equal(same.positions, one.positions)
        assert np.array_equal(same.indices, one.indices)
    zero = karui.subdivide((positions, ragged), 0)
    assert zero.faces is None and zero.offsets.tolist() == [0, 5, 8]
    assert np.array_equal(zero.indices, flat) and len(zero.to_mesh().triangles) == 4


def test_meshes_and_polygons_are_cages(ball):
    one = karui.subdivide(ball, 1, "loop")
    two = karui.subdivide(karui.subdivide(ball, 0), 1, "loop")
    three = karui.subdivide(karui.Mesh.from_arrays(*ball), 1, "loop")
    for other in (two, three):
        assert np.array_equal(one.positions, other.positions)
    coarse = karui.simplify(one, ratio=0.5)  # polygons are meshes, too
    assert len(coarse.mesh.triangles) <= len(one.faces) // 2
    shared = [(p.__array_interface__["data"][0], p.flags.writeable) for p in (one.faces, one.indices)]
    assert shared[0] == shared[1] and not shared[0][1]


def test_a_pyvista_surface_of_quads_is_a_cage():
    surface = SimpleNamespace(points=CORNERS, regular_faces=np.array(QUADS))
    made = karui.subdivide(surface, 2)
    assert np.array_equal(made.positions, karui.subdivide((CORNERS, QUADS), 2).positions)


def test_a_trimesh_object_is_a_cage():
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=1)
    made = karui.subdivide(ball, 2, "loop").to_mesh()
    back = trimesh.Trimesh(made.positions, made.triangles, process=False)
    assert back.is_watertight and len(back.faces) == 16 * len(ball.faces)
    theirs = ball.subdivide_loop(2)
    corners = [np.round(m.vertices[m.faces], 5) + 0.0 for m in (back, theirs)]
    turned = [sorted(min(np.roll(t, k, 0).tolist() for k in range(3)) for t in c) for c in corners]
    assert np.array(turned[0]) == pytest.approx(np.array(turned[1]), abs=2e-5)


def test_seams_of_texture_coordinates_do_not_tear():
    # A strip around a prism of three quads, whose texture ends where it begins.
    ring = [[np.cos(t), np.sin(t)] for t in 2 * np.pi * np.arange(3) / 3]
    positions = [[*p, z] for z in (0, 1) for p in ring]
    faces = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
    uvs = [[u / 3, v] for v in (0, 1) for u in range(4)]
    at = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]])
    cage = karui.ControlMesh.from_arrays(
        positions, faces, uvs=uvs, uv_indices=at.ravel(), colors=[[1, 0, 0, 1]] * 6
    )
    made = karui.subdivide(cage, 3)
    assert made.uvs.shape == (len(made.positions), 2)
    assert made.uvs.min() >= 0 and made.uvs.max() == pytest.approx(1)
    assert made.colors == pytest.approx(np.array([[1, 0, 0, 1]] * len(made.positions)))
    places = len(np.unique(made.positions, axis=0))
    assert places == karui.subdivide((positions, faces), 3).positions.shape[0]
    assert len(made.positions) == places + 9  # the seam, of 8 edges, is there twice
    split = made.to_mesh()  # which has a vertex for each texture coordinate, as files do
    again = karui.subdivide(split, 1)
    assert len(np.unique(again.positions, axis=0)) < len(again.positions)
    refused = {"scheme": "sqrt2", "levels": 1}
    with pytest.raises(karui.InputError, match="scheme"):
        karui.subdivide(cage, **refused)
    assert karui.subdivide(cage, uvs=False, **refused).uvs is None
    charts = karui.Refinement(cage, 3).face_varying(cage.uv_indices, len(cage.uvs))
    values = charts.evaluate(cage.uvs)
    assert np.array_equal(np.unique(values, axis=0), np.unique(made.uvs, axis=0))


OBJ = """v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v 0 0 2
f 4 3 2 1
f 1 2 5
f 2 3 5
f 3 4 5
f 4 1 5
t crease 2/1/0 0 1 3.5
t corner 1/1/0 4 10
t hole 1/0/0 0
t interpolateboundary 1/0/0 1
"""


def test_a_control_mesh_is_read_with_its_tags(tmp_path):
    path = tmp_path / "pyramid.obj"
    path.write_text(OBJ)
    cage = karui.ControlMesh.read(path)
    assert np.diff(cage.offsets).tolist() == [4, 3, 3, 3, 3]
    assert cage.creases.tolist() == [[0, 1]] and cage.crease_sharpness.tolist() == [3.5]
    assert cage.corners.tolist() == [4] and cage.corner_sharpness.tolist() == [10]
    assert cage.holes.tolist() == [0] and cage.uvs is None and cage.warnings == []
    made = karui.subdivide(cage, 2)
    assert len(made.faces) == 4 * 3 * 4 and [0, 0, 2] in made.positions.tolist()
    same = karui.ControlMesh.from_arrays(
        cage.positions, cage.indices, cage.offsets, creases=[[1, 0]], crease_sharpness=3.5,
        corners=[4], holes=[0],
    )
    assert np.array_equal(karui.subdivide(same, 2, boundary="edge").positions, made.positions)
    karui.write(tmp_path / "smooth.ply", made)
    off = tmp_path / "quad.off"
    off.write_text("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
    assert karui.subdivide(karui.ControlMesh.read(off), 1).faces.shape == (4, 4)
    with pytest.raises(karui.FileError):
        karui.ControlMesh.read(tmp_path / "none.obj")


def test_positions_move_and_connectivity_stays():
    cage = karui.ControlMesh.from_arrays(CORNERS, QUADS, creases=EDGES[:4], crease_sharpness=2)
    refinement = karui.Refinement(cage, 3)
    rng = np.random.default_rng(7)
    for _ in range(3):
        moved = (CORNERS + 0.1 * rng.standard_normal(CORNERS.shape)).astype(np.float32)
        anew = karui.subdivide(
            karui.ControlMesh.from_arrays(moved, QUADS, creases=EDGES[:4], crease_sharpness=2), 3
        )
        assert np.array_equal(refinement.evaluate(moved), anew.positions)
        assert np.array_equal(refinement.faces, anew.faces)
        limits = refinement.limits(moved)
        assert limits.positions.shape == limits.normals.shape == (refinement.vertex_count, 3)
        assert limits.tangents.shape == (refinement.vertex_count, 2, 3)
        along = np.einsum("nij,nj->ni", limits.tangents, limits.normals)
        assert np.abs(along).max() < 1e-5 and limits.one_sided.dtype == bool
    assert refinement.offsets.tolist() == list(range(0, 4 * 6 * 64 + 1, 4))
    assert len(refinement.triangles) == 2 * refinement.face_count


def test_anything_is_evaluated():
    refinement = karui.Refinement((CORNERS, QUADS), 2)
    place = refinement.evaluate(CORNERS)
    for columns in (1, 2, 4):
        values = np.arange(8 * columns).reshape(8, columns) % 5
        made = refinement.evaluate(values)
        assert made.shape == (refinement.vertex_count, columns) and made.dtype == np.float32
        for c in range(columns):
            assert np.array_equal(made[:, c], refinement.evaluate(values[:, c]))
    assert np.array_equal(refinement.evaluate(CORNERS[:, 1]), place[:, 1])
    for wrong in (CORNERS[:7], np.zeros((8, 5)), np.full((8, 3), np.nan), np.zeros((2, 2, 2))):
        with pytest.raises(karui.InputError):
            refinement.evaluate(wrong)


def test_the_same_whatever_the_threads(tmp_path):
    program = (
        "import hashlib, karui, numpy as np;"
        "n = 40; x, y = np.meshgrid(np.arange(n), np.arange(n)); c = np.arange(n * n).reshape(n, n);"
        "faces = np.stack([k.ravel() for k in (c[:-1, :-1], c[:-1, 1:], c[1:, 1:], c[1:, :-1])], 1);"
        "p = np.stack([x, y, np.sin(x) * y], -1).reshape(-1, 3);"
        "made = karui.subdivide((p, faces), 4, limit=True, normals=True);"
        "print(hashlib.sha256(made.positions.tobytes() + made.indices.tobytes()"
        " + made.normals.tobytes()).hexdigest())"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True,
            env={**os.environ, "RAYON_NUM_THREADS": threads}, cwd=tmp_path,
        ).stdout
        for threads in ("1", "2", "5")
    }
    assert len(said) == 1


def test_a_view_gets_what_it_sees():
    adaptive = karui.Adaptive((CORNERS, QUADS))
    camera = karui.Camera.looking_at((CORNERS, [[0, 3, 6], [1, 2, 7], [4, 5, 6]]), (0, 0, 1))
    drawn = adaptive.refine(camera, size=(640, 480), pixels=0.5)
    assert not drawn.truncated and drawn.depths.max() > 4 > drawn.depths.min()
    mesh = drawn.mesh
    assert len(drawn.parents) == len(mesh.offsets) - 1 and set(drawn.parents) <= set(range(6))
    assert len(drawn.points) == len(mesh.positions)
    fine = karui.subdivide((CORNERS, QUADS), 6, limit=True).to_mesh()
    assert karui.vertex_distances(mesh, fine).max() < 1e-3  # vertices are on the limit surface
    front = fine.positions[:, 2] > 0.6
    pixel = 2 * np.tan(0.35) * (camera.eye[2] - 0.6) / 480
    assert 0 < karui.vertex_distances(fine, mesh)[front].max() <= 0.5 * pixel
    uniform = adaptive.refine(camera, depth_front=4, depth_silhouette=4, depth_hidden=4).mesh
    assert len(uniform.offsets) - 1 == 6 * 16
    again = adaptive.refine(camera, size=(640, 480), pixels=0.5).mesh
    assert np.array_equal(again.positions, mesh.positions)
    adaptive.move_cage(2 * CORNERS)
    moved = adaptive.refine(camera, depth_front=0, depth_silhouette=0).mesh
    assert sorted(moved.positions.round(6).tolist()) == sorted(CORNERS.tolist())  # 2 * 1/2
    assert adaptive.kept >= 6
    small = adaptive.refine(camera, pixels=0.1, max_faces=50)
    assert small.truncated


NAN = CORNERS.copy()
NAN[3, 1] = np.nan
BAD = {
    "not a number": ((NAN, QUADS), {}, "3"),
    "infinite": ((CORNERS * np.inf, QUADS), {}, "0"),
    "out of range": ((CORNERS, [[0, 1, 8]]), {}, "8"),
    "negative": ((CORNERS, [[0, 1, -1]]), {}, "faces"),
    "one corner": ((CORNERS, [[0, 1, 2], [3]]), {}, "1"),
    "rows of two": ((CORNERS, np.array([[0, 1]])), {}, "0"),
    "rows of none": ((CORNERS, np.zeros((2, 0), int)), {}, "faces"),
    "no faces": ((CORNERS, []), {}, "cage"),
    "floats": ((CORNERS, np.array([[0.0, 1.0, 2.0]])), {}, "integers"),
    "flat": ((np.zeros((8, 2)), QUADS), {}, "positions"),
    "offsets": ((CORNERS, [0, 1, 2, 3], [0, 3]), {}, "offsets"),
    "offsets that fall": ((CORNERS, [0, 1, 2, 3], [0, 5, 4]), {}, "offsets"),
    "a number": (7, {}, "cage"),
    "40 levels": ((CORNERS, QUADS), {"levels": 40}, "40"),
    "quads by loop": ((CORNERS, QUADS), {"scheme": "loop"}, "scheme"),
    "limit of sqrt3": (OCTAHEDRON, {"scheme": "sqrt3", "limit": True}, "Sqrt3"),
    "no such scheme": ((CORNERS, QUADS), {"scheme": "doo-sabin"}, "'catmull-clark' or"),
    "no such rule": ((CORNERS, QUADS), {"boundary": "smooth"}, "boundary"),
    "too many": ((CORNERS, QUADS), {"levels": 3, "max_faces": 383}, "384"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_told(name):
    cage, options, said = BAD[name]
    for make in (karui.subdivide, karui.Refinement):
        if make is karui.Refinement and "limit" in options:
            continue
        with pytest.raises(karui.InputError) as told:
            make(cage, **options)
        assert said in str(told.value)


@pytest.mark.parametrize(
    "tags",
    [
        {"creases": [[0, 9]]},
        {"creases": [0, 1]},
        {"creases": [[0, 1]], "crease_sharpness": -1},
        {"creases": [[0, 1]], "crease_sharpness": [1, 2]},
        {"creases": [[0, 1]], "crease_sharpness": float("nan")},
        {"corners": [8]},
        {"corners": [-1]},
        {"holes": [6]},
        {"uvs": [[0, 0]]},
        {"uvs": [[0, 0]], "uv_indices": [0] * 23},
        {"uvs": [[0, 0]], "uv_indices": [1] * 24},
        {"uv_indices": [0] * 24},
        {"uvs": [[0, np.nan]] * 8},
        {"colors": [[1, 1, 1, 1]]},
        {"colors": [[1, 1, 1]] * 8},
    ],
)
def test_tags_that_fit_nothing_are_refused(tags):
    with pytest.raises(karui.InputError):
        karui.ControlMesh.from_arrays(CORNERS, QUADS, **tags)


def test_long_work_is_stopped():
    with pytest.raises(karui.Cancelled):
        karui.subdivide(quad_grid(120), 5, "bilinear", progress=lambda *_: False)
    three = [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
    with pytest.raises(karui.InputError):
        karui.Adaptive((CORNERS, three))
