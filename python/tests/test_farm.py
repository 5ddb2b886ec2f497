"""One mesh over many targets, on the workers of Dask."""

import json
import os
import pickle
import signal
import threading
import time

import pytest
from distributed import Client, LocalCluster

import mesh_draping as md
from conftest import TOML, drape_command
from mesh_draping import farm

N_TARGETS = 12


@pytest.fixture
def scans(tmp_path):
    """A template and targets that are other individuals."""
    for seed in range(N_TARGETS):
        pair = md.bench.write(tmp_path / str(seed), "head", seed, angle=20, ratio=1.2, landmarks=6)
        (pair / "target.ply").rename(tmp_path / f"scan{seed}.ply")
        (pair / "landmarks.json").rename(tmp_path / f"scan{seed}.json")
    (tmp_path / "0/source.obj").rename(tmp_path / "head.obj")
    (tmp_path / "short.toml").write_text(TOML)
    return tmp_path


def test_a_lost_worker_loses_only_its_row(scans, monkeypatch):
    monkeypatch.chdir(scans)
    targets = [f"scan{seed}.ply" for seed in range(N_TARGETS)]
    marks, options = "{target}.json", ["--config", "short.toml"]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        lost = threading.Thread(target=_kill_one, args=(client, scans / "sum/shards"))
        lost.start()
        done = farm.batch(
            "head.obj", targets, "out/{target}.obj",
            landmarks=marks, summary="sum", options=options, client=client,
        )  # fmt: skip
        lost.join()
        began = time.monotonic()
        again = farm.batch(
            "head.obj", targets, "out/{target}.obj",
            landmarks=marks, summary="sum", options=options, client=client,
        )  # fmt: skip
    assert [row["pair"] for row in done.rows] == [target[:-4] for target in targets]
    assert all(row["error"] is None for row in done.rows)
    assert [row["finished"] for row in again.rows] == [row["finished"] for row in done.rows]
    assert done.page.is_file() and len(done.table.read_text().splitlines()) == N_TARGETS + 1
    _same_as_in_series(scans, targets)


def _kill_one(client, shards):
    """Ends a worker for good when the first row is there."""
    while not list(shards.glob("*.jsonl")):
        time.sleep(0.05)
    pids = client.run(os.getpid)
    os.kill(next(iter(pids.values())), signal.SIGKILL)


def _same_as_in_series(scans, targets):
    line = ["batch", "head.obj", *targets, "-l", "{target}.json", "-o", "series/{target}.obj"]
    drape_command(*line, "--config", "short.toml", "--summary", "series", cwd=scans)
    for target in targets:
        name = target.replace(".ply", ".obj")
        assert (scans / "out" / name).read_bytes() == (scans / "series" / name).read_bytes()
    rows = json.loads((scans / "series/results.json").read_text())
    assert len(rows) == len(targets)


def test_what_a_worker_is_told_does_not_grow_with_the_list(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    few, many = (farm.command("a.obj", [f"{k}.ply" for k in range(n)], "{target}.obj") for n in (2, 2000))
    assert len(pickle.dumps(many)) < len(pickle.dumps(few)) + 10
    monkeypatch.setattr(farm, "_drape_one", lambda job: (tmp_path / f"{job[1]}.done").touch())
    with Client(processes=False, dashboard_address=None) as client:
        farm._drape_all(client, many, list(range(1, 2001)), threads=1)
    assert {path.stem for path in tmp_path.glob("*.done")} == {str(k) for k in range(1, 2001)}


def test_a_target_that_cannot_be_draped_is_a_row_of_its_own(scans, monkeypatch):
    monkeypatch.chdir(scans)
    (scans / "broken.ply").write_text("ply\n")
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        done = farm.batch(
            "head.obj", ["scan0.ply", "broken.ply"], "out/{target}.obj",
            summary="sum", options=["--config", "short.toml"], client=client,
        )  # fmt: skip
    assert done.rows[0]["error"] is None and "broken.ply" in done.rows[1]["error"]
