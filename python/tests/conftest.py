"""A creature as files and as arrays, and settings that are soon done."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mesh_draping as md

#: A drape of a few steps: what is tested here is the way in and out.
SHORT = {"stages": [{"n_iterations": 12}], "initial": "standard"}
TOML = 'preset = "quick"\ninitial = "standard"\n[[stages]]\nn_iterations = 12\n'


def drape_command(*arguments, cwd=None, env=None):
    """The command of this very installation; gives its standard output."""
    line = [sys.executable, "-m", "mesh_draping", *map(str, arguments)]
    ended = subprocess.run(line, cwd=cwd, env=env, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder with a head: source.obj, target.ply, landmarks.json, truth.npy, short.toml, and what the command made."""
    folder = md.bench.write(tmp_path_factory.mktemp("pair"), "head", seed=1, landmarks=10)
    (folder / "short.toml").write_text(TOML)
    drape_command(
        "transfer", "source.obj", "target.ply", "-l", "landmarks.json", "-o", "draped.obj",
        "--config", "short.toml", "--seed", "3", cwd=folder,
    )  # fmt: skip
    return folder


@pytest.fixture(scope="session")
def pair(folder):
    """The same head in memory: the very numbers of the files, whose faces go part by part."""
    made = md.bench.pair("head", seed=1, landmarks=10)
    source, target = md.Source(folder / "source.obj"), md.Source(folder / "target.ply", weld="off")
    return made._replace(
        source=(source.vertices, source.faces), target=(target.vertices, target.faces)
    )


@pytest.fixture(scope="session")
def commanded(folder):
    """Where the command line brought the vertices."""
    return obj_vertices(folder / "draped.obj")


@pytest.fixture(scope="session")
def result(folder):
    """The same drape from Python, from files."""
    files = (folder / name for name in ("source.obj", "target.ply", "landmarks.json"))
    return md.drape(*files, "quick", 3, **SHORT)


def obj_vertices(path: Path):
    """The vertices of an OBJ file, to the last bit."""
    lines = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]])


def shared(name: str):
    """A pair of the data that is handed around with the sources; none where it is not here."""
    here = Path(os.environ.get("MESH_DRAPING_DATA", Path(__file__).parents[3] / "shared/data/pairs"))
    return here / name if (here / name).is_dir() else None
