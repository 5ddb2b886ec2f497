#!/usr/bin/env python3
"""Who reads what: files in every dialect we know of, written by code, read by us, trimesh, meshio and assimp.

    python3 -m venv venv && venv/bin/pip install trimesh meshio assimp_py scipy
    cargo build -p drape-cli
    venv/bin/python tests/interop/dialects.py [--drape target/debug/drape] [--keep FOLDER] [--page docs/formats.md]

Prints a Markdown table, or writes it between the marks of a page: for each file whether each reader finds what is meant
(`yes`), finds something else (`wrong`), refuses (`–`) or takes its process with it (`crash`). Exit code 1 where we read a
file wrong, or refuse one that we mean to read. Not part of the test run.
"""
import argparse
import base64
import contextlib
import gzip
import importlib.metadata
import io
import json
import logging
import multiprocessing
import pathlib
import struct
import subprocess
import sys
import tempfile
import warnings

import assimp_py
import meshio
import trimesh

TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
READ, REFUSE = "read", "refuse"

# ---- text formats

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
ROWS = "0 0 0\n1 0 0\n0 1 0\n"
PLY_HEAD = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n")
PLY = PLY_HEAD + ROWS + "3 0 1 2\n"
STL = ("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
       "endsolid a\n")
OFF = "OFF\n3 1 0\n" + ROWS + "3 0 1 2\n"
MARK = b"\xef\xbb\xbf"


def binary_ply(item, face):
    head = PLY_HEAD.replace("ascii", "binary_little_endian").replace("uchar int", f"uchar {item}").encode()
    return head + b"".join(struct.pack("<3f", *p) for p in TRIANGLE) + face


def binary_stl(n, stated=None, behind=b""):
    out = bytes(80) + struct.pack("<I", n if stated is None else stated)
    for k in range(n):
        out += struct.pack("<12fH", 0, 0, 1, 2 * k, 0, 0, 2 * k + 1, 0, 0, 2 * k, 1, 0, 0)
    return out + behind


# ---- glTF

def gltf(corners=struct.pack("<3H", 0, 1, 2) + bytes(2), **changes):
    positions = b"".join(struct.pack("<3f", *p) for p in TRIANGLE)
    data = positions + corners
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": len(data) - 36}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }
    document.update(changes)
    return json.dumps(document)


def skinned():
    positions = b"".join(struct.pack("<3f", *p) for p in TRIANGLE)
    joints = bytes(12)
    weights = struct.pack("<4f", 1, 0, 0, 0) * 3
    data = positions + joints + weights
    view = lambda offset, length: {"buffer": 0, "byteOffset": offset, "byteLength": length}
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"translation": [0, 0, 5]}], "skins": [{"joints": [1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4"}],
        "bufferViews": [view(0, 36), view(36, 12), view(48, 48)],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    })


def quantised():
    data = b"".join(struct.pack("<4H", *(65535 * c for c in p), 0) for p in TRIANGLE) + struct.pack("<3H", 0, 1, 2)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return gltf(
        extensionsUsed=["KHR_mesh_quantization"], extensionsRequired=["KHR_mesh_quantization"],
        accessors=[
            {"bufferView": 0, "componentType": 5123, "normalized": True, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [65535, 65535, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        bufferViews=[{"buffer": 0, "byteLength": 24, "byteStride": 8}, {"buffer": 0, "byteOffset": 24, "byteLength": 6}],
        buffers=[{"byteLength": len(data), "uri": uri}])


def instanced(key):
    node = {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}
    return gltf(nodes=[node], **{key: ["EXT_mesh_gpu_instancing"]})


def whole_floats(text):
    for key in ("count", "mesh", "componentType", "byteLength", "buffer"):
        text = text.replace(f'"{key}": ', f'"{key}": #')
    digits = "0123456789"
    parts = text.split("#")
    return parts[0] + "".join(
        part[:(n := len(part) - len(part.lstrip(digits)))] + ".0" + part[n:] for part in parts[1:])


def dialects():
    """Name, content, what is meant (points and number of triangles), whether we mean to read it."""
    def one(name, content, ours=READ, meant=(TRIANGLE, 1)):
        return name, content if isinstance(content, bytes) else content.encode(), meant, ours

    vertical = [(x, y, 5) for x, y, _ in TRIANGLE]
    two = [(2 * k + x, y, z) for k in range(2) for x, y, z in TRIANGLE]
    commas = [(-1.5, -1.5, -1.5), (2.5, 0.25, 3)]
    yield one("plain.obj", OBJ)
    yield one("byte-order mark.obj", MARK + OBJ.encode())
    yield one("UTF-16.obj", OBJ.encode("utf-16"))
    yield one("zeros behind.obj", OBJ.encode() + bytes(3))
    yield one("corners with empty slashes.obj", OBJ.replace("f 1 2 3", "f 1/ 2// 3///"))
    yield one("indented.obj", OBJ.replace("v", " v").replace("f", "\tf"))
    yield one("comment behind a face.obj", OBJ.replace("1 2 3", "1 2 3 # c"))
    yield one("lines of words.obj", "hello world\n// exported\n" + OBJ)
    yield one("faces first.obj", "f 1 2 3\n" + OBJ[:-8])
    yield one("named as STL.stl", OBJ)
    yield one("named as PLY.ply", OBJ)
    yield one("gzip named as OFF.off", gzip.compress(OBJ.encode()))
    yield one("corner out of range.obj", OBJ.replace("f 1 2 3", "f 1 2 4"), REFUSE)
    yield one("plain.ply", PLY)
    yield one("byte-order mark.ply", MARK + PLY.encode())
    yield one("face rows with more columns.ply", PLY.replace("3 0 1 2", "3 0 1 2 255 0 0"))
    yield one("vertex rows with more columns.ply", PLY.replace("1 0 0", "1 0 0 9"))
    yield one("blank lines.ply", PLY.replace("1 0 0", "\n1 0 0"))
    yield one("faces of floats.ply", PLY.replace("uchar int", "uchar float"))
    yield one("faces of floats, binary.ply", binary_ply("float", struct.pack("<B3f", 3, 0, 1, 2)))
    yield one("faces of 64 bits, binary.ply", binary_ply("int64", struct.pack("<B3q", 3, 0, 1, 2)))
    yield one("whole numbers with a point.ply", PLY.replace("3 0 1 2", "3 0.0 1.0 2.0"))
    yield one("a count with a point.ply", PLY.replace("vertex 3", "vertex 3.0"))
    yield one("PLY in capitals.ply", PLY.replace("ply\n", "PLY \n", 1))
    yield one("cut short, binary.ply", binary_ply("int", struct.pack("<B2i", 3, 0, 1)), REFUSE)
    yield one("faces without corners.ply", PLY.replace("list uchar int vertex_indices", "uchar red").replace("3 0 1 2", "9"), REFUSE)
    yield one("plain.stl", STL)
    yield one("all on one line.stl", STL.replace("\n", " "))
    yield one("colours.stl", STL.replace("outer", "color 0.5 0.5 0.5\nouter"))
    yield one("comments.stl", STL.replace("outer", "# c\n// c\n; c\nouter"))
    yield one("comment on top.stl", "# c\n" + STL)
    yield one("no endsolid.stl", STL.replace("endsolid a\n", ""))
    yield one("no normals.stl", STL.replace(" normal 0 0 1", ""))
    yield one("cut short.stl", STL[:STL.index("endloop")], REFUSE)
    yield one("binary.stl", binary_stl(2), meant=(two, 2))
    yield one("binary, counts 1 of 2.stl", binary_stl(2, 1), meant=(two, 2))
    yield one("binary, counts 3 of 2.stl", binary_stl(2, 3), meant=(two, 2))
    yield one("binary, counts 0 of 2.stl", binary_stl(2, 0), meant=(two, 2))
    yield one("binary, bytes behind.stl", binary_stl(2, behind=b"more"), meant=(two, 2))
    yield one("binary, cut short.stl", binary_stl(2)[:-10], REFUSE, meant=(two, 2))
    yield one("plain.off", OFF)
    yield one("byte-order mark.off", MARK + OFF.encode())
    yield one("no keyword.off", OFF[4:])
    yield one("two counts.off", OFF.replace("3 1 0", "3 1"))
    yield one("colours.off", OFF.replace("3 0 1 2", "3 0 1 2 255 0 0"))
    yield one("plain.xyz", ROWS, meant=(TRIANGLE, 0))
    yield one("decimal commas and semicolons.xyz", "-1,5;-1,5;-1,5\n2,5;0,25;3\n", meant=(commas, 0))
    yield one("decimal commas and blanks.xyz", "-1,5 -1,5 -1,5\n2,5 0,25 3\n", meant=(commas, 0))
    yield one("decimal commas or not.xyz", "1.5;2,5;3\n", REFUSE, meant=([(1.5, 2.5, 3)], 0))
    yield one("plain.gltf", gltf())
    yield one("byte-order mark.gltf", MARK + gltf().encode())
    yield one("named as OBJ.obj", gltf())
    yield one("extras as a number.gltf", gltf(extras=3))
    yield one("extras as text.gltf", gltf(nodes=[{"mesh": 0, "extras": "x"}]))
    yield one("an animation without a node.gltf", gltf(animations=[{"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": [{"input": 0, "output": 0}]}]))
    yield one("a scene without nodes.gltf", gltf(scenes=[{"nodes": [0]}, {"name": "x"}]))
    yield one("whole numbers with a point.gltf", whole_floats(gltf()))
    yield one("skinned.gltf", skinned(), meant=(vertical, 1))
    yield one("quantised.gltf", quantised())
    yield one("instances required.gltf", instanced("extensionsRequired"), REFUSE)
    yield one("corners as floats.gltf", gltf(struct.pack("<3f", 0, 1, 2)).replace("5123", "5126"), REFUSE)
    # The data is plain: a reader that does not look at what is required reads it.
    for word, name in (("Draco", "KHR_draco_mesh_compression"), ("meshopt", "EXT_meshopt_compression")):
        yield one(f"{word} required.gltf", gltf(extensionsUsed=[name], extensionsRequired=[name]), REFUSE)
    yield one("version 1.gltf", json.dumps({"asset": {"version": "1.0"}, "meshes": {"m": {}}}), REFUSE)


# ---- readers: points and the number of triangles

def with_trimesh(path):
    loaded = trimesh.load(path, process=False, maintain_order=True)
    if isinstance(loaded, trimesh.Scene):
        loaded = loaded.to_mesh()
    return [tuple(p) for p in loaded.vertices], len(getattr(loaded, "faces", []))


def with_meshio(path):
    loaded = meshio.read(path)
    cells = [block for block in loaded.cells if block.dim == 2]
    return [tuple(p) for p in loaded.points], sum(len(block.data) for block in cells)


def with_assimp(path):
    flags = assimp_py.Process_Triangulate | assimp_py.Process_PreTransformVertices
    meshes = assimp_py.import_file(str(path), flags).meshes
    points = [tuple(m.vertices[3 * k:3 * k + 3]) for m in meshes for k in range(m.num_vertices)]
    return points, sum(len(m.indices) // 3 for m in meshes)


def with_drape(drape):
    def read(path):
        found = subprocess.run([drape, "inspect", path, "--json"], capture_output=True, text=True, check=True)
        found = json.loads(found.stdout)
        triangles = sum((int(n) - 2) * count for n, count in found["faces_by_corners"].items() if int(n) > 2)
        return (found["box_min"], found["box_max"]), triangles
    return read


def box(points):
    return [min(p[k] for p in points) for k in range(3)], [max(p[k] for p in points) for k in range(3)]


def verdict(read, path, meant):
    points, n_triangles = meant
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            found, n_found = read(path)
        bounds = found if isinstance(found, tuple) else box(found)
    except (Exception, SystemExit):  # whatever a reader says, it does not read the file
        return "–"
    is_near = all(abs(a - b) < 1e-4 for s, t in zip(bounds, box(points)) for a, b in zip(s, t))
    return "yes" if n_found == n_triangles and is_near else "wrong"


def verdict_apart(read, path, meant):
    """The verdict of a process of its own, for a reader may take its process with it."""
    processes = multiprocessing.get_context("fork")
    receiver, sender = processes.Pipe(duplex=False)
    child = processes.Process(target=lambda: sender.send(verdict(read, path, meant)))
    child.start()
    child.join()
    return receiver.recv() if child.exitcode == 0 else "crash"


MARKS = "<!-- written by tests/interop/dialects.py -->\n", "<!-- end -->\n"


def write_into(page, table):
    """The page with the table between its marks."""
    before, rest = page.read_text().split(MARKS[0])
    _, after = rest.split(MARKS[1])
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("trimesh", "meshio", "assimp_py"))
    page.write_text(f"{before}{MARKS[0]}With {versions}:\n\n{table}{MARKS[1]}{after}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--drape", default=pathlib.Path(__file__).resolve().parents[2] / "target/debug/drape")
    parser.add_argument("--keep", type=pathlib.Path, help="leave the files in this folder")
    parser.add_argument("--page", type=pathlib.Path, help="write the table between the marks of this page")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    readers = dict(drape=with_drape(arguments.drape), trimesh=with_trimesh, meshio=with_meshio, assimp=with_assimp)
    n_bad = 0
    table = "| file | " + " | ".join(readers) + " |\n|---|" + "---|" * len(readers) + "\n"
    with tempfile.TemporaryDirectory() as folder:
        folder = arguments.keep or pathlib.Path(folder)
        folder.mkdir(exist_ok=True)
        for name, content, meant, ours in dialects():
            path = folder / name
            path.write_bytes(content)
            verdicts = [verdict_apart(read, path, meant) for read in readers.values()]
            is_right = verdicts[0] == ("yes" if ours == READ else "–")
            n_bad += not is_right
            table += f"| {name} | " + " | ".join(verdicts) + (" | ← |\n" if not is_right else " |\n")
    if arguments.page:
        write_into(arguments.page, table)
    else:
        print(table, end="")
    sys.exit(n_bad > 0)


if __name__ == "__main__":
    main()
