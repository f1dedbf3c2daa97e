"""Files in and out."""

import json

import numpy as np
import pytest
from conftest import CLOTH, grid

import karui


def json_of(glb):
    data = glb.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + length])


def test_a_scene_keeps_what_is_around_its_meshes(tmp_path):
    scene = karui.read(CLOTH)
    assert scene.warnings == [] and len(scene.names) == len(scene.meshes) == 1
    coarse = [karui.simplify(mesh, ratio=0.1).mesh for mesh in scene.meshes]
    written = tmp_path / "cloth.glb"
    assert karui.write(written, scene.with_meshes(coarse)) == []
    before, after = json_of(CLOTH), json_of(written)
    for kept in ("materials", "textures", "nodes"):
        assert len(after[kept]) == len(before[kept])
    assert after["materials"][0]["name"] == before["materials"][0]["name"]
    back = karui.read(written)
    assert np.array_equal(back.meshes[0].triangles, coarse[0].triangles)
    assert len(back.merged().triangles) == len(coarse[0].triangles)
    with pytest.raises(karui.InputError, match="as many"):
        scene.with_meshes([])


@pytest.mark.parametrize("extension", ["ply", "obj", "stl", "off", "glb", "obj.gz"])
def test_meshes_are_written_and_read(hills, tmp_path, extension):
    path = tmp_path / f"hills.{extension}"
    karui.write(path, hills)
    back = karui.Mesh.read(str(path))
    assert np.array_equal(back.positions[back.triangles], hills[0][hills[1]])


def test_what_is_lost_is_told(tmp_path):
    mesh = karui.Mesh.from_arrays(*grid(2), uvs=np.zeros((4, 2)))
    assert karui.write(tmp_path / "a.stl", mesh)
    assert karui.write(tmp_path / "a.ply", mesh) == []


def test_errors_have_types(tmp_path):
    with pytest.raises(karui.FileError, match="no such file"):
        karui.read(tmp_path / "none.ply")
    with pytest.raises(OSError):
        karui.Mesh.read(tmp_path / "none.ply")
    broken = tmp_path / "broken.ply"
    broken.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n1 2")
    with pytest.raises(karui.InputError, match="broken.ply"):
        karui.read(broken)
    with pytest.raises(karui.InputError, match="unknown format"):
        karui.write(tmp_path / "a.xyz", grid(2))
    with pytest.raises(karui.FileError):
        karui.write(tmp_path / "none" / "a.ply", grid(2))
    assert [p.name for p in tmp_path.iterdir()] == ["broken.ply"]
    assert issubclass(karui.Cancelled, karui.KaruiError)


def test_a_scene_is_drawn_with_its_materials():
    textured = karui.render(karui.read(CLOTH), size=(64, 64))
    bare = karui.render(karui.Mesh.read(CLOTH), size=(64, 64))
    assert np.array_equal(textured[..., 3] > 0, bare[..., 3] > 0)
    assert not np.array_equal(textured, bare)
