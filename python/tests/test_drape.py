"""The drape: the same bits whatever way it is asked for."""

import threading
import time

import numpy as np
import pytest

import mesh_draping as md
from conftest import SHORT, obj_vertices, shared


def test_files_give_the_bytes_of_the_command_line(folder, result):
    result.write(folder / "python.obj")
    assert (folder / "python.obj").read_bytes() == (folder / "draped.obj").read_bytes()


def test_arrays_give_its_bits(pair, commanded):
    result = md.drape(pair.source, pair.target, pair.landmarks, "quick", 3, **SHORT)
    assert np.array_equal(result.vertices, commanded)
    assert result.vertices.dtype == np.float64 and result.vertices.flags.c_contiguous


def test_lists_of_polygons_and_of_pairs_give_its_bits(pair, commanded):
    (vertices, faces), (points, triangles) = pair.source, pair.target
    source = (vertices.tolist(), [list(map(int, face)) for face in faces])
    pairs = [(l["source"]["vertex"], l["target"]["point"]) for l in pair.landmarks]
    result = md.drape(source, (points, triangles.tolist()), pairs, "quick", 3, **SHORT)
    assert np.array_equal(result.vertices, commanded)
    assert len(md.landmarks.check(pairs[:2], source, pair.target).residuals) == 2
    arrays = tuple(map(np.array, zip(*pairs)))
    assert len(md.landmarks.check(arrays, source, pair.target).residuals) == len(pairs)


def test_a_target_of_trimesh_gives_its_bits(pair, commanded):
    trimesh = pytest.importorskip("trimesh")
    target = trimesh.Trimesh(*pair.target, process=False)
    result = md.drape(pair.source, target, pair.landmarks, "quick", 3, **SHORT)
    assert np.array_equal(result.vertices, commanded)
    made = result.to_trimesh()
    assert np.array_equal(made.vertices, commanded) and len(made.faces) == 2 * len(result.faces)


def test_a_source_of_trimesh_is_draped(pair):
    trimesh = pytest.importorskip("trimesh")
    vertices, quads = pair.source
    source = trimesh.Trimesh(vertices, trimesh.geometry.triangulate_quads(quads), process=False)
    result = md.drape(source, pair.target, pair.landmarks, "quick", **SHORT)
    assert result.faces.shape == (2 * len(quads), 3)
    assert np.array_equal(result.faces, source.faces)


def test_faces_stay_as_they_are(pair, result):
    assert np.array_equal(result.faces, pair.source[1])
    assert len(result.vertices) == len(result.initial) == len(result.distances) == len(pair.source[0])


def test_points_with_and_without_normals_are_draped_over():
    cloud = md.bench.pair("head", seed=1, landmarks=6, variant="cloud")
    alone = md.drape(cloud.source, cloud.target, cloud.landmarks, "quick", **SHORT)
    outward = cloud.target - cloud.target.mean(axis=0)
    facing = md.drape(cloud.source, (cloud.target, None, outward), cloud.landmarks, "quick", **SHORT)
    assert alone.figures["hausdorff"] < 0.2 and facing.figures["hausdorff"] < 0.2


def test_steps_are_those_of_the_run(pair, commanded):
    run = md.Drape(pair.source, pair.target, pair.landmarks, "quick", 3, **SHORT)
    assert (run.iteration, run.n_iterations) == (0, 12)
    first = run.step()
    assert (first.iteration, run.iteration) == (0, 1) and first.total > 0
    value, weight = first.terms["chamfer"] if "chamfer" in first.terms else next(iter(first.terms.values()))
    assert value >= 0 and weight >= 0
    assert run.vertices.shape == run.initial.shape == pair.source[0].shape
    seen = []
    result = run.run(seen.append)
    assert [step.iteration for step in seen] == list(range(1, 12))
    assert np.array_equal(result.vertices, commanded)
    with pytest.raises(md.Error, match="finished"):
        run.step()


def test_a_bar_of_tqdm_is_shown(pair, capfd):
    md.drape(pair.source, pair.target, pair.landmarks, "quick", progress=True, **SHORT)
    assert "12/12" in capfd.readouterr().err


def test_a_drape_is_cancelled_from_another_thread(pair):
    run = md.Drape(pair.source, pair.target, pair.landmarks)
    timer = threading.Timer(0.3, run.cancel)
    timer.start()
    with pytest.raises(md.Cancelled):
        run.run()
    assert run.is_cancelled and run.iteration < run.n_iterations


def test_other_threads_go_on_meanwhile(pair):
    ticks, is_over = [], threading.Event()

    def tick():
        while not is_over.wait(0.005):
            ticks.append(time.monotonic())

    watch = threading.Thread(target=tick)
    watch.start()
    md.drape(pair.source, pair.target, pair.landmarks, "quick", **SHORT)
    is_over.set()
    watch.join()
    # With the lock held throughout, the thread would be let in a few times only.
    assert len(ticks) > 20


def test_landmarks_can_be_changed_on_the_way(pair):
    run = md.Drape(pair.source, pair.target, pair.landmarks[:4], "quick", **SHORT)
    run.step()
    run.set_landmarks(pair.landmarks)
    run.extend(2)
    result = run.run()
    assert result.figures["landmark_rms"] < 0.1


def test_parts_are_carried_or_rigid(pair):
    vertices, faces = pair.source
    body = np.flatnonzero(vertices[:, 1] > np.quantile(vertices[:, 1], 0.9))
    source = md.Source(pair.source, parts={"top": body})
    result = md.drape(source, pair.target, pair.landmarks, "quick", rigid=["top"], **SHORT)
    before = vertices[body] - vertices[body].mean(axis=0)
    after = result.vertices[body] - result.vertices[body].mean(axis=0)
    ratio = np.linalg.norm(after, axis=1) / np.linalg.norm(before, axis=1)
    assert np.ptp(ratio) < 1e-6
    with pytest.raises(md.Error, match="neither a name in the source nor a file"):
        md.drape(source, pair.target, pair.landmarks, "quick", free=["hat"], **SHORT)


def test_truth_and_report_are_told(pair):
    result = md.drape(pair.source, pair.target, pair.landmarks, "quick", truth=pair.truth, **SHORT)
    figures = result.figures
    assert 0 < figures["truth_mean"] < figures["truth_max"] and 0 < figures["q_transfer"] <= 1
    assert result.history and result.explanation["regions"] and "Q" in str(result)
    assert result.settings["stages"][0]["n_iterations"] == 12
    judged = md.metrics(pair.source, result.vertices, pair.target, pair.landmarks, truth=pair.truth)
    assert judged.figures["q_transfer"] == figures["q_transfer"]


@pytest.mark.parametrize("name", ["horse_wolf", "ict_identity_gt"])
def test_pairs_of_the_data_give_the_bits_of_the_command_line(name, tmp_path):
    from conftest import drape_command

    data = shared(name)
    if data is None:
        pytest.skip(f"no data of {name} here")
    source, target = (next(data.glob(f"{kind}.*")) for kind in ("source", "target"))
    marks = next(data.glob("landmarks.json"))
    drape_command("transfer", source, target, "-l", marks, "-o", tmp_path / "c.obj", "--preset", "quick")
    result = md.drape(source, target, marks, "quick")
    result.write(tmp_path / "p.obj")
    assert (tmp_path / "p.obj").read_bytes() == (tmp_path / "c.obj").read_bytes()
    read = md.Source(source)
    over = md.Target(target).vertices
    faces = md.Source(target, weld="off").faces
    arrays = md.drape((read.vertices, read.faces), (over, faces), marks, "quick")
    assert np.array_equal(arrays.vertices, obj_vertices(tmp_path / "c.obj"))
