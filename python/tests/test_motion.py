"""Frames of a motion, each from the one before."""

import numpy as np
import pytest
import trimesh

import mesh_draping as md

N_FRAMES = 4


def test_a_frame_that_starts_from_the_one_before_is_near_the_truth_and_soon_done():
    frames = list(md.bench.motion("head", 0, 40, angle=20, landmarks=10))[8 : 8 + N_FRAMES]
    first = frames[0]
    result = md.drape(first.source, first.target, first.landmarks, "quick", truth=first.truth)
    alone = md.Drape(first.source, first.target, first.landmarks, "quick").n_iterations
    for frame in frames[1:]:
        run = md.Drape(frame.source, frame.target, None, "quick", start=result.vertices, truth=frame.truth)
        assert run.n_iterations <= alone / 2 and np.array_equal(run.initial, result.vertices)
        before = md.metrics(frame.source, result.vertices, frame.target, truth=frame.truth).figures
        result = run.run()
        assert result.figures["mean_l2_sum"] < before["mean_l2_sum"]
        assert result.figures["truth_mean"] < 0.02


def test_what_slides_along_the_surface_is_led_back_to_the_first_frame():
    first, *frames = list(md.bench.motion("person", 0, 24, ratio=1.2))[:7:2]
    kept = led = first.truth
    for frame in frames:
        given = (frame.source, frame.target, frame.landmarks, "quick")
        kept = md.drape(*given, start=kept)
        led = md.drape(*given, start=led, first_frame=first.truth)
    off_kept, off_led = (np.linalg.norm(end.vertices - frames[-1].truth, axis=1).mean() for end in (kept, led))
    assert off_led < 0.7 * off_kept
    with pytest.raises(md.Error, match="a first frame needs a start"):
        md.drape(*given, first_frame=first.truth)


def test_a_result_is_as_symmetric_as_its_source():
    ball = trimesh.creation.icosphere(3)
    source = np.asarray(ball.vertices) * [1.0, 1.4, 0.8]
    # A dent on one side only.
    dent = np.exp(-8.0 * np.linalg.norm(source - [0.7, 0.5, 0.4], axis=1) ** 2)
    target = source * (1.2 - 0.3 * dent[:, None])
    marks = [(row, target[row]) for row in np.argsort(source @ [0.3, 1.0, 0.2])[::90]]
    settings = {"stages": [{"n_iterations": 12}], "initial": "standard", "symmetric": True}
    result = md.drape((source, ball.faces), (target, ball.faces), marks, "quick", **settings)
    rows = {place(p): row for row, p in enumerate(source)}
    for plane in range(3):
        flip = np.where(np.arange(3) == plane, -1, 1)
        across = result.vertices - result.vertices[[rows[place(p * flip)] for p in source]]
        normal = np.linalg.svd(across, full_matrices=False)[2][0]
        along = across - np.outer(across @ normal, normal)
        if np.abs(along).max() < 1e-6:
            return
    raise AssertionError("no plane of the source is one of the result")


def place(point):
    """A point as a key, near points as one."""
    return tuple(np.round(point, 6) + 0.0)
