"""The add-on, under a Blender without windows."""

import json
import zipfile
from pathlib import Path

import bpy
import mesh_draping_addon as addon
import numpy as np
import pytest
from conftest import SHORT, mesh_object, values
from mathutils import Matrix, Vector
from mesh_draping_addon import marks, operators, transfer, wait

import mesh_draping as md


def single(rows):
    """As Blender keeps it."""
    return np.asarray(rows, dtype=np.float32).reshape(-1).tolist()


def expected(pair):
    """What the library makes of the very vertices that Blender has."""
    kept = [(np.float64(np.float32(v)), f) for v, f in (pair.source, pair.target)]
    places = [{**m, "target": {"point": np.float32(m["target"]["point"]).astype(float).tolist()}} for m in pair.landmarks]
    return md.drape(*kept, sorted(places, key=lambda m: m["name"]), "quick", 0, **SHORT)


def test_a_new_object_has_the_bits_of_the_library(rigged, pair):
    assert bpy.ops.mesh_draping.drape() == {"FINISHED"}
    draped = bpy.data.objects["head draped"]
    assert values(draped.data.vertices, "co", 3) == single(expected(pair).vertices)
    assert rigged.told.startswith("Q ")


def test_nothing_else_of_the_source_changes(rigged, snapshot):
    before = snapshot(rigged.source)
    bpy.ops.mesh_draping.drape()
    assert snapshot(rigged.source) == before


def test_the_result_has_all_that_hangs_on_the_source(rigged, snapshot):
    before = snapshot(rigged.source)
    bpy.ops.mesh_draping.drape()
    after = snapshot(bpy.data.objects["head draped"])
    assert after["attributes"].pop(transfer.HEAT)[:2] == ("FLOAT_COLOR", "POINT")
    assert after.pop("vertices") != before.pop("vertices")
    old, new = before.pop("keys"), after.pop("keys")
    assert [told for told, _ in old] == [told for told, _ in new]
    for name, value in before.items():
        assert after[name] == value, name


def test_shape_keys_are_carried_over(rigged):
    bpy.ops.mesh_draping.drape()
    mesh = bpy.data.objects["head draped"].data
    basis, smile = (values(key.data, "co", 3) for key in mesh.shape_keys.key_blocks)
    assert basis == values(mesh.vertices, "co", 3)
    offsets = np.reshape(smile, (-1, 3)) - np.reshape(basis, (-1, 3))
    moved = np.flatnonzero(np.linalg.norm(offsets, axis=1) > 1e-4)
    assert set(moved) <= set(range(40)) and len(moved) > 30


def test_a_shape_key_of_the_source_is_the_result(rigged, pair, snapshot):
    before = snapshot(rigged.source)
    rigged.result = "shape_key"
    bpy.ops.mesh_draping.drape()
    key = rigged.source.data.shape_keys.key_blocks[transfer.SHAPE_KEY]
    assert values(key.data, "co", 3) == single(expected(pair).vertices)
    after = snapshot(rigged.source)
    after["attributes"].pop(transfer.HEAT)
    assert after.pop("keys")[:2] == before.pop("keys")
    assert after == before
    bpy.ops.mesh_draping.drape()
    assert len(rigged.source.data.shape_keys.key_blocks) == 3


def test_objects_count_where_they_stand_in_the_world(rigged, pair):
    turn = Matrix.Rotation(0.7, 4, "Z") @ Matrix.Translation((3, 1, 0)) @ Matrix.Scale(2.0, 4)
    rigged.target.matrix_world = turn
    rigged.source.matrix_world = Matrix.Translation((0, 0, 5))
    bpy.context.view_layer.update()
    bpy.ops.mesh_draping.drape()
    draped = bpy.data.objects["head draped"]
    bpy.context.view_layer.update()
    stands = np.array([draped.matrix_world @ v.co for v in draped.data.vertices])
    over = np.array([turn @ Vector(p) for p in pair.truth])
    assert np.linalg.norm(stands - over, axis=1).mean() < 0.05 * np.ptp(over)


def test_vertex_groups_are_rigid_or_free_parts(rigged, pair):
    jaw = rigged.source.vertex_groups["jaw"]
    top = np.argsort(pair.source[0][:, 1])[-60:].tolist()
    jaw.remove(range(len(pair.source[0])))
    jaw.add(top, 1.0, "REPLACE")
    bpy.ops.mesh_draping.parts(action="add")
    rigged.parts[0].group, rigged.parts[0].treatment = "jaw", "rigid"
    bpy.ops.mesh_draping.drape()
    draped = bpy.data.objects["head draped"]
    after = np.array([draped.data.vertices[v].co for v in top])
    before = pair.source[0][top]
    ratio = np.linalg.norm(after - after.mean(axis=0), axis=1) / np.linalg.norm(before - before.mean(axis=0), axis=1)
    assert np.ptp(ratio) < 1e-4
    rigged.parts[0].group = "hat"
    with pytest.raises(RuntimeError, match="no vertex group 'hat'"):
        bpy.ops.mesh_draping.drape()
    bpy.ops.mesh_draping.parts(action="remove", index=0)
    assert len(rigged.parts) == 0


def test_marks_are_made_of_selected_vertices(rigged):
    for thing, row in ((rigged.source, 5), (rigged.target, 9)):
        thing.data.vertices.foreach_set("select", [v == row for v in range(len(thing.data.vertices))])
    bpy.ops.mesh_draping.mark_vertices(name="wart")
    entry = next(e for e in marks.entries(rigged) if e["name"] == "wart")
    assert (entry["source"], entry["target"]) == ({"vertex": 5}, {"vertex": 9})
    marks.find(rigged, "wart", "source").location.x += 0.1
    entry = next(e for e in marks.entries(rigged) if e["name"] == "wart")
    assert "point" in entry["source"]


def test_marks_are_picked_by_a_ray(rigged):
    bpy.context.view_layer.update()
    rigged.source.location.x = 100.0
    bpy.context.view_layer.update()
    box = np.array(rigged.target.bound_box)
    origin = Vector((*box.mean(axis=0)[:2], box[:, 2].max() + 1.0))
    pick = operators.DRAPE_OT_eyedropper.pick
    assert pick(bpy.context, origin, Vector((0, 0, -1)))
    assert pick(bpy.context, origin + Vector((100, 0, 0)), Vector((0, 0, -1)))
    assert not pick(bpy.context, origin + Vector((50, 0, 0)), Vector((0, 0, -1)))
    entry = next(e for e in marks.entries(rigged) if e["name"] == "mark 1")
    assert entry["source"]["point"][0] > 90 and abs(entry["target"]["point"][0]) < 10


def test_empties_set_by_hand_are_marks(rigged):
    for side, thing in (("source", rigged.source), ("target", rigged.target)):
        empty = bpy.data.objects.new(f"chin.{side}", None)
        rigged.marks.objects.link(empty)
        empty.location = thing.data.vertices[3].co
    entry = next(e for e in marks.entries(rigged) if e["name"] == "chin")
    assert "point" in entry["source"] and "point" in entry["target"]


def test_landmark_files_are_read_and_written(rigged, tmp_path, pair):
    path = tmp_path / "marks.json"
    bpy.ops.mesh_draping.write_marks(filepath=str(path))
    written = json.loads(path.read_text())["landmarks"]
    assert [e["name"] for e in written] == sorted(m["name"] for m in pair.landmarks)
    by_name = {m["name"]: m for m in pair.landmarks}
    assert all(e["source"] == by_name[e["name"]]["source"] for e in written)
    for empty in list(rigged.marks.objects):
        bpy.data.objects.remove(empty)
    bpy.ops.mesh_draping.read_marks(filepath=str(path))
    assert marks.entries(rigged) == written
    assert bpy.ops.mesh_draping.check_marks() == {"FINISHED"}
    path.write_text("{")
    with pytest.raises(RuntimeError, match="is not JSON"):
        bpy.ops.mesh_draping.read_marks(filepath=str(path))


def test_a_drape_on_its_thread_is_cancelled(rigged):
    running = wait.Running(transfer.inputs(rigged))
    running.cancel()
    running.wait()
    assert running.is_over and isinstance(running.error, md.Cancelled) and running.result is None


def test_what_lacks_is_said(scene):
    with pytest.raises(RuntimeError, match="choose a source and a target"):
        bpy.ops.mesh_draping.drape()
    scene.mesh_draping.source = scene.mesh_draping.target = mesh_object("one", np.eye(3), [[0, 1, 2]])
    with pytest.raises(RuntimeError, match="the same object"):
        bpy.ops.mesh_draping.drape()


def test_the_extension_is_whole(tmp_path):
    import subprocess
    import sys

    wheel = tmp_path / "mesh_draping-0.1.0-cp310-abi3-linux_x86_64.whl"
    wheel.write_bytes(b"")
    built = tmp_path / "mesh_draping.zip"
    build = Path(addon.__file__).parents[1] / "build.py"
    subprocess.run([sys.executable, build, built, wheel], check=True)
    assert f"wheels/{wheel.name}" in zipfile.ZipFile(built).namelist()
    judge = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core/bl_pkg/cli/blender_ext.py"
    judged = subprocess.run([sys.executable, judge, "validate", built], capture_output=True, text=True)
    assert judged.returncode == 0, judged.stdout + judged.stderr
