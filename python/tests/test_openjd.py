"""The template for render farms, by the tool of its makers."""

import json
import os
import subprocess
import sys
from pathlib import Path

import mesh_draping as md
from conftest import TOML

TEMPLATE = Path(__file__).parents[1] / "openjd/drape-batch.yaml"


def openjd(*arguments):
    programs = Path(sys.executable).parent
    # The template calls `drape`, as a machine of a farm has it.
    env = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}
    line = [programs / "openjd", *map(str, arguments)]
    ended = subprocess.run(line, capture_output=True, text=True, env=env)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


def test_the_template_is_one():
    openjd("check", TEMPLATE)


def test_its_tasks_make_one_table(tmp_path):
    scans = tmp_path / "scans"
    for seed in range(3):
        pair = md.bench.write(tmp_path / str(seed), "head", seed, angle=20, ratio=1.2, landmarks=6)
        scans.mkdir(exist_ok=True)
        (pair / "target.ply").rename(scans / f"scan{seed}.ply")
        (pair / "landmarks.json").rename(scans / f"scan{seed}.json")
    (tmp_path / "short.toml").write_text(TOML)
    given = {
        "Source": tmp_path / "0/source.obj",
        "Targets": scans,
        "Results": tmp_path / "results",
        "Options": f"--config {tmp_path / 'short.toml'}",
        "Parts": 2,
    }
    (tmp_path / "results").mkdir()
    parameters = [word for name, value in given.items() for word in ("-p", f"{name}={value}")]
    openjd("run", TEMPLATE, "--step", "Table", "--run-dependencies", *parameters)
    rows = json.loads((tmp_path / "results/results.json").read_text())
    assert [row["pair"] for row in rows] == ["scan0", "scan1", "scan2"]
    assert len(list((tmp_path / "results/shards").glob("*.jsonl"))) == 2
    assert all(row["error"] is None for row in rows)
