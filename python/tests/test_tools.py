"""Landmarks, the map, the bench and the command."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

import mesh_draping as md
from conftest import drape_command


def test_landmarks_are_read_written_and_looked_at(folder, pair, tmp_path):
    source, target = md.Source(folder / "source.obj"), md.Target(folder / "target.ply")
    entries = md.landmarks.read(folder / "landmarks.json", source, target)
    assert [e["name"] for e in entries] == [e["name"] for e in pair.landmarks]
    for form in ("json", "lists", "text", "points"):
        md.landmarks.write(entries, source, target, tmp_path / form, form)
        again = md.landmarks.read(tmp_path / form, source, target)
        assert [e["source"] for e in again] == [e["source"] for e in entries]
    assert md.landmarks.write(entries, source, target, tmp_path / "ids", "ids") > 0
    check = md.landmarks.check(entries, source, target)
    assert len(check.residuals) == 10
    exchanged = [{**entries[0], "target": entries[5]["target"]}, *entries[1:]]
    assert len(md.landmarks.check(exchanged, source, target).findings) > len(check.findings)
    told = drape_command(
        "landmarks", "suggest", "source.obj", "target.ply", "landmarks.json", "--json", "-n", "2", cwd=folder
    )
    assert md.landmarks.suggest(entries, source, target, 2) == json.loads(told)["suggestions"]


def test_point_files_of_wrap_are_read_and_written(pair, tmp_path):
    files = tmp_path / "source.json", tmp_path / "target.json"
    md.landmarks.write_wrap(pair.landmarks, pair.source, pair.target, *files)
    again = md.landmarks.read_wrap(*files, pair.source, pair.target)
    assert {e["name"]: e["source"] for e in again} == {m["name"]: m["source"] for m in pair.landmarks}
    with pytest.raises(md.Error, match="none.json"):
        md.landmarks.read_wrap(tmp_path / "none.json", files[1], pair.source, pair.target)


def test_landmarks_of_one_half_are_mirrored():
    source, target, marks, _ = md.bench.pair("head", seed=0, angle=0, ratio=1, landmarks=20)
    half = [m for m in marks if not m["name"].startswith("right")]
    assert len(half) < len(marks) and len(md.landmarks.mirror(half, source, target)) > len(half)


def test_the_map_moves_other_points(result, folder, tmp_path):
    source = md.Source(folder / "source.obj")
    warp = result.warp()
    moved = warp.apply(source.vertices)
    assert np.abs(moved - result.vertices).max() < 1e-9 * np.ptp(result.vertices)
    warp.save(tmp_path / "w.drape")
    assert np.array_equal(md.Warp.load(tmp_path / "w.drape").apply(source.vertices), moved)
    with pytest.raises(md.Error, match="none.drape"):
        md.Warp.load(tmp_path / "none.drape")


def test_the_initial_deformation_is_that_of_the_command(folder):
    from conftest import obj_vertices

    files = ("source.obj", "target.ply", "landmarks.json")
    drape_command("init", *files[:2], "-l", files[2], "-o", "init.obj", cwd=folder)
    shape = md.init(*(folder / name for name in files))
    assert np.array_equal(shape, obj_vertices(folder / "init.obj"))


def test_results_of_others_are_judged(folder, pair):
    files = [folder / name for name in ("source.obj", "draped.obj", "target.ply", "landmarks.json")]
    told = json.loads(drape_command("metrics", *files[:3], "-l", files[3], "--json"))
    judged = md.metrics(*files)
    assert judged.figures == pytest.approx(told["figures"], abs=0)
    assert md.metrics(pair.source, pair.truth, pair.target, truth=pair.truth).figures["truth_max"] == 0


def test_creatures_have_a_truth(tmp_path):
    rows = md.bench.run(["head"], [1], "quick", landmarks=10)
    assert len(rows) == 1 and rows[0]["truth_mean"] < 0.03
    with pytest.raises(md.Error, match="dragon"):
        md.bench.pair("dragon")


def test_the_command_is_installed(folder, tmp_path):
    installed = Path(sys.executable).with_name("drape")
    told = subprocess.run([installed, "--version"], capture_output=True, text=True)
    assert told.returncode == 0 and told.stdout.startswith("drape ")
    wrong = subprocess.run([installed, "transfer"], capture_output=True, text=True)
    assert wrong.returncode == 2 and wrong.stderr.startswith("error: ")
    line = ["batch", "source.obj", "target.ply", "-l", "landmarks.json", "-o", tmp_path / "{target}.obj"]
    drape_command(*line, "--config", "short.toml", "--summary", tmp_path / "s", cwd=folder)
    assert (tmp_path / "s/index.html").is_file() and (tmp_path / "target.obj").is_file()


def test_colours_normals_and_relief_are_baked(result, folder, tmp_path):
    target = trimesh.load(folder / "target.ply", process=False)
    target.visual.vertex_colors = np.tile([200, 100, 50, 255], (len(target.vertices), 1))
    target.export(tmp_path / "painted.ply")
    maps = [tmp_path / name for name in ("colours.png", "normals.png", "relief.png")]
    told = result.bake(
        maps[0], normal=maps[1], displacement=maps[2], size=64, depth=16, painted=tmp_path / "painted.ply"
    )
    assert any(words.startswith("displacement: white is") for words in told)
    # Width, height, bits and samples: red, green and blue, or grey.
    heads = [path.read_bytes()[16:26] for path in maps]
    assert heads == [bytes([0, 0, 0, 64, 0, 0, 0, 64, 16, samples]) for samples in (2, 2, 0)]
    with pytest.raises(md.Error, match="neither colours"):
        result.bake(maps[0])


def test_a_drape_from_file_to_file_does_without_numpy(folder, tmp_path):
    lines = (
        "import sys, mesh_draping as md",
        "result = md.drape('source.obj', 'target.ply', 'landmarks.json', config='short.toml')",
        f"result.write({str(tmp_path / 'draped.obj')!r}), result.figures, str(result)",
        "assert 'numpy' not in sys.modules",
        "assert result.vertices.shape[1] == 3",
    )
    ended = subprocess.run([sys.executable, "-c", "\n".join(lines)], cwd=folder, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
