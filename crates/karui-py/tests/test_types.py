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
