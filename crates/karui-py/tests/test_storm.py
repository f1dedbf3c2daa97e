"""A plan on several nodes that are killed; storm.py has more of it."""

import random

import pytest


def test_a_storm_changes_no_byte(tmp_path):
    pytest.importorskip("ray")
    from storm import storm

    random.seed(7)
    assert storm(rounds=3, side=500, block=40_000, longest=2.0, folder=tmp_path) == 0
