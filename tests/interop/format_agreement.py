#!/usr/bin/env python3
"""Holds our readers and writers against trimesh: vertex, face and UV counts, and positions. Not part of the test run.

    python3 -m venv venv && venv/bin/pip install trimesh plyfile scipy
    cargo build --release -p drape-cli
    venv/bin/python tests/interop/format_agreement.py FOLDER... [--drape target/release/drape]

Every mesh file under the folders is inspected by `drape inspect --json` and loaded by trimesh; then `drape apply` sends
it through a warp that moves every vertex, into each format we write, and trimesh must find the positions that we meant
and the faces of the source. Exit code 1 where the two disagree.

trimesh cuts polygons into triangles, so faces are compared as the number of triangles that polygons become. It merges or
splits vertices by what their corners name, so vertices of a text format are counted by `process=False,
maintain_order=True`, and where it still splits them (OBJ with UVs) by the `v` lines of the file.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
import plyfile
import trimesh
from scipy.spatial import cKDTree

EXTENSIONS = {".obj", ".ply", ".stl", ".off", ".glb", ".gltf"}


def run(drape, *arguments):
    return subprocess.run([drape, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def inspect(drape, path):
    return json.loads(run(drape, "inspect", path, "--json"))


def load(path):
    """One geometry of all that is in the file, vertices in their order, in the coordinates of the scene."""
    try:
        scene = trimesh.load(path, process=False, maintain_order=True)
    except (ValueError, TypeError):
        if path.suffix == ".ply":
            return load_mixed_ply(path)
        if path.suffix == ".off":
            return load_mixed_off(path)
        raise
    if not isinstance(scene, trimesh.Scene):
        return scene
    parts = [part for part in scene.dump() if len(part.vertices)]
    return parts[0] if len(parts) == 1 else trimesh.util.concatenate(parts)


def load_mixed_ply(path):
    """trimesh refuses a binary PLY whose faces have different numbers of corners; plyfile reads it."""
    data = plyfile.PlyData.read(path)
    vertices = np.stack([data["vertex"][axis] for axis in "xyz"], axis=1)
    polygons = data["face"]["vertex_indices"]
    fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    return trimesh.Trimesh(vertices, fans, process=False)


def load_mixed_off(path):
    """trimesh stumbles over polygons of five or more corners in an OFF file."""
    lines = [line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    n_vertices, n_faces = int(lines[1][0]), int(lines[1][1])
    vertices = np.array(lines[2:2 + n_vertices], dtype=float)[:, :3]
    polygons = [[int(word) for word in line[1:1 + int(line[0])]] for line in lines[2 + n_vertices:][:n_faces]]
    fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    return trimesh.Trimesh(vertices, fans, process=False)


def n_uvs(geometry):
    uv = getattr(getattr(geometry, "visual", None), "uv", None)
    return 0 if uv is None else len(uv)


def obj_counts(path):
    """Vertices, texture coordinates and triangles by the lines of the file."""
    counts = dict(v=0, vt=0, triangles=0)
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words and words[0] in ("v", "vt"):
            counts[words[0]] += 1
        elif words and words[0] == "f":
            counts["triangles"] += max(len(words) - 3, 0)
    return counts


def n_triangles(found):
    return sum((int(corners) - 2) * n for corners, n in found["faces_by_corners"].items() if int(corners) > 2)


def disagreements(path, found):
    geometry = load(path)
    theirs = dict(vertices=len(geometry.vertices), faces=len(getattr(geometry, "faces", [])), uvs=n_uvs(geometry))
    ours = dict(vertices=found["vertices"], faces=n_triangles(found), uvs=found["texture_coordinates"])
    if path.suffix == ".obj":
        # trimesh makes a vertex of each pair of position and UV, and none of a position that no face names.
        lines = obj_counts(path)
        if theirs["vertices"] != ours["vertices"] or theirs["uvs"] != ours["uvs"]:
            theirs.update(vertices=lines["v"], uvs=lines["vt"])
        used = np.unique(np.asarray(geometry.vertices), axis=0)
        if len(used) > found["places"]:
            yield f"trimesh has {len(used)} places, we {found['places']}"
    elif path.suffix == ".stl":
        theirs["vertices"] = len(np.unique(np.asarray(geometry.vertices), axis=0))
    elif path.suffix == ".ply" and theirs["uvs"] != ours["uvs"]:
        theirs["uvs"] = ply_uvs(path, theirs)
    for what, n in ours.items():
        if theirs[what] != n:
            yield f"{what}: trimesh {theirs[what]}, we {n}"


def ply_uvs(path, theirs):
    """trimesh reads only some names of UV properties: those in the header count."""
    header = path.read_bytes().split(b"end_header")[0].decode(errors="replace")
    return theirs["vertices"] if re.search(r"property \w+ (u|s|texture_u)\n", header) else theirs["uvs"]


def positions_disagree(meant, path):
    """Whether trimesh finds other places in a file that we wrote than those we meant, to single precision."""
    found = np.unique(np.asarray(load(path).vertices).round(9), axis=0)
    tolerance = 2e-6 * np.abs(meant).max()
    return cKDTree(meant).query(found)[0].max() > tolerance


def check_written(drape, folder, path, found, warp):
    """Our outputs of one file, each judged by trimesh."""
    moved = folder / f"moved{path.suffix}"
    run(drape, "apply", warp, path, "-o", moved)
    again = inspect(drape, moved)
    for key in ("faces_by_corners", "vertices", "texture_coordinates", "normals", "groups", "materials"):
        if again[key] != found[key]:
            yield f"{moved.name}: {key} changed from {found[key]} to {again[key]}"
    meant = np.asarray(load(moved).vertices)
    yield from (f"{moved.name}: {text}" for text in disagreements(moved, again))
    for other in ("obj", "off", "ply", "stl", "glb"):
        if f".{other}" == path.suffix or not found["faces"]:
            continue
        written = folder / f"converted.{other}"
        run(drape, "apply", warp, path, "-o", written)
        converted = inspect(drape, written)
        yield from (f"{written.name}: {text}" for text in disagreements(written, converted))
        if positions_disagree(meant, written):
            yield f"{written.name}: other positions than {moved.name}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--drape", default=pathlib.Path(__file__).resolve().parents[2] / "target/release/drape")
    arguments = parser.parse_args()
    paths = sorted(p for folder in arguments.folders for p in folder.rglob("*") if p.suffix in EXTENSIONS)
    n_bad = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        warp = make_warp(arguments.drape, folder)
        for path in paths:
            found = inspect(arguments.drape, path)
            complaints = list(disagreements(path, found))
            complaints += check_written(arguments.drape, folder, path, found, warp)
            n_bad += bool(complaints)
            print(f"{path}: {found['vertices']} vertices, {found['faces']} faces,"
                  f" {found['texture_coordinates']} UVs: {'; '.join(complaints) or 'agreed'}", flush=True)
    print(f"{len(paths)} files, {n_bad} disagreements")
    sys.exit(n_bad > 0)


def make_warp(drape, folder):
    """A warp that moves everything: a tetrahedron stretched into another."""
    faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (folder / "from.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + faces)
    (folder / "to.obj").write_text("v 0.5 0 0\nv 2.5 0 0\nv 0.5 1.25 0\nv 0.5 0 1.5\n" + faces)
    (folder / "short.toml").write_text("[[stages]]\nn_iterations = 1\n")
    run(drape, "transfer", folder / "from.obj", folder / "to.obj", "--config", folder / "short.toml",
        "-o", folder / "out.obj", "--warp", folder / "map.drape")
    return folder / "map.drape"


if __name__ == "__main__":
    main()
