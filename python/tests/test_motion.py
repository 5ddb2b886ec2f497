"""Frames of a motion, each from the one before."""

import numpy as np

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


def test_a_result_is_as_symmetric_as_its_source():
    pair = md.bench.pair("head", seed=1, landmarks=10)
    settings = {"stages": [{"n_iterations": 12}], "initial": "standard"}
    result = md.drape(pair.source, pair.target, pair.landmarks, "quick", symmetric=True, **settings)
    # The plane of the template is x = 0.
    rows = {place(p): row for row, p in enumerate(pair.source[0])}
    opposite = [rows[place(p * [-1, 1, 1])] for p in pair.source[0]]
    across = result.vertices - result.vertices[opposite]
    normal = np.linalg.svd(across, full_matrices=False)[2][0]
    along = across - np.outer(across @ normal, normal)
    assert np.abs(along).max() < 1e-6 * np.ptp(result.vertices)


def place(point):
    """A point as a key, near points as one."""
    return tuple(np.round(point, 6) + 0.0)
