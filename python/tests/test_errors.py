"""What is wrong is said in the words of the command line."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import mesh_draping as md
from conftest import SHORT


@pytest.mark.parametrize(
    "mesh, told",
    [
        ((np.zeros((3, 2)), [[0, 1, 2]]), "shape"),
        ((np.zeros((3, 3)), [[0, 1, 2]]), "all its points are at one place"),
        ((np.eye(3), [[0, 1, 7]]), "7"),
        ((np.eye(3), [[0, 1, -1]]), "vertex -1"),
        ((np.eye(3), [[0.5, 1.0, 2.0]]), "whole numbers"),
        ((np.eye(3) * np.nan, [[0, 1, 2]]), "finite"),
        (np.eye(3), "needs faces"),
        (12, "is no mesh"),
    ],
)
def test_a_mesh_that_is_none_is_refused(mesh, told):
    with pytest.raises(md.Error, match=told):
        md.Source(mesh)


def test_errors_are_those_of_the_command_line(folder):
    files = [folder / "source.obj", folder / "target.ply", folder / "none.json"]
    line = [sys.executable, "-m", "mesh_draping", "transfer", *files[:2], "-l", files[2], "-o", folder / "x.obj"]
    ended = subprocess.run(list(map(str, line)), capture_output=True, text=True)
    with pytest.raises(md.Error) as error:
        md.drape(*files)
    assert ended.returncode == 2 and ended.stderr.strip() == f"error: {error.value}"


def test_settings_that_are_none_are_named(pair):
    for settings, told in [
        ({"preset": "best"}, "no preset 'best'"),
        ({"sed": 1}, "unknown field `sed`"),
        ({"sampling": {"n_samples": -1}}, "n_samples"),
        ({"overlap": "some"}, "some"),
        ({"initial": object()}, "settings"),
    ]:
        with pytest.raises(md.Error, match=told):
            md.Drape(pair.source, pair.target, pair.landmarks, **settings)


def test_a_landmark_that_is_none_is_named(pair):
    for landmarks, told in [
        ([(10**6, [0, 0, 0])], "source vertex 1000000"),
        ([(0, [0, 0])], "three numbers"),
        ([3], "no landmark"),
        ([{"source": {"vertex": 0}, "goal": 1}], "goal"),
    ]:
        with pytest.raises(md.Error, match=told):
            md.init(pair.source, pair.target, landmarks)


CTRL_C = """
import sys, mesh_draping as md
pair = md.bench.pair("head")
print("go", flush=True)
md.drape(*pair[:3], progress=lambda step: print(step.iteration, flush=True))
"""


@pytest.mark.parametrize("when", ["start", "steps"])
def test_ctrl_c_stops_a_drape(when):
    # A program that runs in the background of a shell starts with the signal ignored, and so would what it starts.
    heard = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    command = [sys.executable, "-c", CTRL_C]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heard)
    assert run.stdout.readline() == "go\n"
    if when == "steps":
        run.stdout.readline()
    began = time.monotonic()
    run.send_signal(signal.SIGINT)
    _, told = run.communicate(timeout=60)
    assert run.returncode != 0 and "KeyboardInterrupt" in told
    assert time.monotonic() - began < 20


def test_settings_are_told_as_toml():
    assert md.presets()[0] == "standard"
    assert 'preset = "quick"' in md.settings("quick", seed=7)
    assert "seed = 7" in md.settings("quick", seed=7)
    assert md.settings(overlap="both") == md.settings(overlap="both-partial") != md.settings()
    assert "n_iterations = 12" in md.settings("quick", **SHORT)
