"""Shapes that the tests share."""

from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
CLOTH = ROOT / "assets" / "sheen_cloth.glb"


def grid(side, height=lambda x, y: 0.0 * x):
    """A square of (side - 1)^2 x 2 triangles over [0, 1]^2."""
    x, y = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    positions = np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3)
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        part.ravel()
        for part in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    )
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return positions.astype(np.float32), triangles.astype(np.uint32)


def sphere(side=64):
    """The unit sphere, closed, as a grid of longitudes and latitudes with two poles."""
    turn = 2 * np.pi * np.arange(2 * side) / (2 * side)
    fall = np.pi * np.arange(1, side) / side
    u, v = np.meshgrid(turn, fall)
    around = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], -1)
    positions = np.concatenate([around.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    ring = np.arange((side - 1) * 2 * side).reshape(side - 1, 2 * side)
    right = np.roll(ring, -1, axis=1)
    north, south = len(positions) - 2, len(positions) - 1
    quads = [
        np.stack([ring[:-1], ring[1:], right[1:]], -1),
        np.stack([ring[:-1], right[1:], right[:-1]], -1),
    ]
    caps = [
        np.stack([np.full(2 * side, north), ring[0], right[0]], -1),
        np.stack([np.full(2 * side, south), right[-1], ring[-1]], -1),
    ]
    triangles = np.concatenate([part.reshape(-1, 3) for part in quads + caps])
    return positions.astype(np.float32), triangles.astype(np.uint32)


@pytest.fixture(scope="session")
def ball():
    return sphere()


@pytest.fixture(scope="session")
def hills():
    return grid(200, lambda x, y: 0.1 * np.sin(9 * x) * np.cos(7 * y))
