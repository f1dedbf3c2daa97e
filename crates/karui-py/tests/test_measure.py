"""Distances, saliency and pictures, against closed forms."""

import numpy as np
import pytest
from conftest import grid

import karui


def test_two_squares_are_as_far_apart_as_they_lie(hills):
    positions, triangles = grid(10)
    apart = positions + np.float32([0, 0, 0.25])
    found = karui.measure((positions, triangles), (apart, triangles), samples=1000)
    for figure in (found.max, found.mean, found.rms, found.a_to_b.max, found.b_to_a.rms):
        assert figure == pytest.approx(0.25)
    assert found.diagonal == pytest.approx(2**0.5)
    assert found.a_to_b.samples > 1000
    here, there = np.array(found.a_to_b.farthest)
    assert np.allclose(there - here, [0, 0, 0.25])
    assert karui.measure(hills, hills, samples=1000).max < 1e-7


def test_every_vertex_is_measured(ball):
    positions, triangles = ball
    larger = positions * np.float32(1.5)
    found = karui.vertex_distances((larger, triangles), ball)
    assert found.dtype == np.float32 and found.shape == (len(positions),)
    assert np.allclose(found, 0.5, atol=2e-3)


def test_weights_mask(ball):
    positions, triangles = ball
    dented = positions.copy()
    dented[positions[:, 2] > 0.9] *= np.float32(0.8)
    south = (positions[:, 2] < 0).astype(np.float32)
    assert karui.measure(ball, (dented, triangles), samples=5000).max > 0.1
    masked = karui.measure(ball, (dented, triangles), samples=5000, weights=south)
    assert masked.max < 1e-6


@pytest.mark.parametrize("kind", ["curvature", "mesh", "image", "hybrid", "lee2005"])
def test_saliency_is_between_0_and_1(kind):
    bump = lambda x, y: 0.2 * np.exp(-200 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    values = karui.saliency(grid(40, bump), kind)
    assert values.dtype == np.float32 and values.shape == (1600,)
    assert values.min() >= 0 and 0 < values.max() <= 1


def test_a_bump_is_what_bends():
    bump = lambda x, y: 0.2 * np.exp(-200 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    positions, triangles = grid(60, bump)
    values = karui.saliency((positions, triangles), "curvature")
    far = np.hypot(positions[:, 0] - 0.5, positions[:, 1] - 0.5) > 0.3
    assert values[far].max() < 0.1 * values[~far].max()


def test_weights_of_a_saliency():
    weights = karui.saliency_weights([0.0, 0.5, 1.0])
    assert np.allclose(weights, [1, 1 + 299 * 0.5**8, 300])
    assert np.allclose(karui.saliency_weights([0, 1], most=5, power=1), [1, 5])
    for bad in ({"saliency": [np.nan]}, {"saliency": [0.5], "most": -1}):
        with pytest.raises(karui.InputError):
            karui.saliency_weights(**bad)
    with pytest.raises(karui.InputError, match="'curvature' or"):
        karui.saliency(grid(3), "taste")


def test_a_ball_fills_what_a_disc_does(ball):
    camera = karui.Camera((0, 0, 10), (0, 0, 0), height=4)
    picture = karui.render(ball, camera, size=(300, 200), samples=1)
    assert picture.shape == (200, 300, 4) and picture.dtype == np.uint8
    seen = (picture[..., 3] > 0).sum()
    assert seen == pytest.approx(np.pi * 50**2, rel=0.01)
    rows, columns = np.nonzero(picture[..., 3])
    assert abs(rows.mean() - 99.5) < 0.5 and abs(columns.mean() - 149.5) < 0.5
    for bad in ({"size": (0, 10)}, {"samples": 3}):
        with pytest.raises(karui.InputError):
            karui.render(ball, **bad)
