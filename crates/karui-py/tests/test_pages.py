"""The page in docs/ and the examples do what they say."""

import re
import subprocess
import sys

import pytest
from conftest import CLOTH, ROOT

PAGE = ROOT / "docs" / "python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXAMPLES = {
    "trimesh_lod.py": "trimesh",
    "trimesh_subdivide.py": "trimesh",
    "pyvista_saliency.py": "pyvista",
}


def blocks():
    return BLOCK.findall(PAGE.read_text())


def test_the_page_runs_from_top_to_bottom(tmp_path, monkeypatch):
    code = blocks()
    assert len(code) > 8
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cloth.glb").write_bytes(CLOTH.read_bytes())
    names = {}
    for number, block in enumerate(code):
        if "cluster" in block:
            pytest.importorskip("ray")
        exec(compile(block, f"python.md, block {number}", "exec"), names)


def test_the_page_tells_of_everything():
    import karui

    text = PAGE.read_text()
    assert [name for name in karui.__all__ if name not in text] == []


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_run(example):
    pytest.importorskip(EXAMPLES[example])
    path = ROOT / "crates" / "karui-py" / "examples" / example
    said = subprocess.run([sys.executable, path], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    assert "triangles" in said.stdout


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_say_what_they_need(example):
    path = ROOT / "crates" / "karui-py" / "examples" / example
    hide = f"import sys, runpy; sys.modules[{EXAMPLES[example]!r}] = None; runpy.run_path({str(path)!r})"
    said = subprocess.run([sys.executable, "-c", hide], capture_output=True, text=True)
    assert said.returncode == 1 and "pip install" in said.stderr
