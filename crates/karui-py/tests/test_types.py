"""The stubs say what is there."""

import inspect
import subprocess
import sys

import pytest

import karui


def test_everything_is_described():
    for name in karui.__all__:
        thing = getattr(karui, name)
        assert inspect.getdoc(thing), name
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            assert member.startswith("_") or inspect.getdoc(value), f"{name}.{member}"


def test_stubs_agree_with_the_module():
    pytest.importorskip("mypy")
    checked = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "karui"], capture_output=True, text=True
    )
    assert checked.returncode == 0, checked.stdout


PROGRAM = """
import numpy as np
import karui
import karui.cluster

mesh: karui.Mesh = karui.simplify((np.zeros((3, 3)), [[0, 1, 2]]), ratio=0.5).mesh
height: np.float32 = mesh.positions[0, 2]
report: karui.cluster.Report = karui.cluster.run(karui.Plan.open("work"), wave=10)
smooth: karui.Polygons = karui.subdivide((np.zeros((3, 3)), [[0, 1, 2]]), 2, "loop")
karui.simplify(mesh, quality="best")
karui.simplify(7)
karui.subdivide(mesh, scheme="doo-sabin")
"""


def test_programs_are_checked(tmp_path):
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--strict", str(program)]
    said = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path).stdout
    wrong = [line.split(":")[1] for line in said.splitlines() if "error:" in line]
    assert wrong == ["10", "11", "12"], said
