#!/usr/bin/env python3
"""Turns SHREC'07 with the landmarks of Blended Intrinsic Maps (BIM) into a manifest for `drape evaluate`.

    python3 docs/studies/shrec07.py MESHES LANDMARKS PAIRS OUT
    drape evaluate OUT/shrec07.toml -o runs --jobs 4
    drape evaluate --study paper OUT/shrec07.toml -o studies --jobs 4

MESHES     folder of the models: 1.off, 2.off, ...
LANDMARKS  folder of their places: 1.vts, 2.vts, ...; line k of one model belongs to line k of another. A line is the number of
           a vertex, counted from 0, perhaps with its coordinates behind it; a negative number, or an empty line, is no place
PAIRS      text file with two models a line: names or numbers, with or without folder and extension; # begins a comment
OUT        folder for the manifest and a landmark file for each pair

Where coordinates stand behind the numbers and fit vertices counted from 1, they are taken to be counted from 1. Needs no more than
Python 3.8. Exit code 2, and one line, where a file does not read or nothing is left.
"""

import json
import sys
from pathlib import Path

NEAR = 1e-3  # of the box's diagonal: a vertex is where its line says


class Mistake(Exception):
    """What is wrong with a file, and where."""


def lines_of(path):
    try:
        return path.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise Mistake(f"{path}: {error}") from None


def vertices(path):
    """The vertices of an OFF file."""
    words = (line.split("#")[0].split() for line in lines_of(path))
    rows = [row for row in words if row]
    if rows and rows[0][0].upper().endswith("OFF"):
        rows[0] = rows[0][1:]
        rows = rows if rows[0] else rows[1:]
    try:
        n = int(rows[0][0])
        found = [tuple(float(x) for x in row[:3]) for row in rows[1 : n + 1]]
    except (IndexError, ValueError):
        raise Mistake(f"{path}: no OFF file with vertices") from None
    if len(found) != n or any(len(p) != 3 for p in found):
        raise Mistake(f"{path}: {len(found)} vertices where {n} are announced")
    return found


def places(path):
    """For each line a vertex and where it is said to be, or None."""
    found = []
    for number, line in enumerate(lines_of(path), 1):
        words = line.replace(",", " ").split()
        try:
            vertex = int(words[0]) if words else -1
            point = tuple(float(x) for x in words[1:4])
        except ValueError:
            raise Mistake(f"{path}, line {number}: '{line.strip()}' is no vertex") from None
        found.append((vertex, point if len(point) == 3 else None) if vertex >= 0 else None)
    while found and found[-1] is None:
        found.pop()
    return found


def counted_from(points, landmarks):
    """0, or 1 where the coordinates behind the numbers say so."""
    told = [(v, p) for v, p in filter(None, landmarks) if p is not None]
    low, high = [[f(p[k] for p in points) for k in range(3)] for f in (min, max)]
    near = NEAR * sum((b - a) ** 2 for a, b in zip(low, high)) ** 0.5

    def misses(first):
        rows = [(v - first, p) for v, p in told]
        return sum(
            not 0 <= v < len(points) or max(abs(a - b) for a, b in zip(points[v], p)) > near
            for v, p in rows
        )

    return 1 if told and misses(1) == 0 < misses(0) else 0


class Models:
    """Models by name, each read once."""

    def __init__(self, meshes, landmarks):
        self.meshes, self.landmarks, self.known = meshes, landmarks, {}

    def get(self, name):
        """The path of a model and the vertex of each of its landmarks, or None."""
        if name not in self.known:
            mesh, marks = self.meshes / f"{name}.off", self.landmarks / f"{name}.vts"
            points, found = vertices(mesh), places(marks)
            first = counted_from(points, found)
            rows = [None if place is None else place[0] - first for place in found]
            for number, row in enumerate(rows, 1):
                if row is not None and not 0 <= row < len(points):
                    raise Mistake(f"{marks}, line {number}: the model has {len(points)} vertices")
            self.known[name] = (mesh.resolve(), rows)
        return self.known[name]


def pairs(path):
    """The names of the models of each pair."""
    for number, line in enumerate(lines_of(path), 1):
        words = line.split("#")[0].replace(",", " ").split()
        if not words:
            continue
        if len(words) < 2:
            raise Mistake(f"{path}, line {number}: a pair is two models")
        yield tuple(Path(word).stem for word in words[:2])


def write(models, listed, out):
    """Writes a landmark file for each pair, then the manifest; how many pairs there are."""
    out.mkdir(parents=True, exist_ok=True)
    entries = []
    for a, b in listed:
        (source, at_source), (target, at_target) = models.get(a), models.get(b)
        both = [(s, t) for s, t in zip(at_source, at_target) if s is not None and t is not None]
        marks = [{"source": {"vertex": s}, "target": {"vertex": t}} for s, t in both]
        name = f"{a}-{b}"
        (out / f"{name}.json").write_text(json.dumps({"landmarks": marks}) + "\n")
        entries.append(
            f"[[pair]]\nname = {json.dumps(name)}\nsection = \"SHREC'07/BIM\"\n"
            f"source = {json.dumps(str(source))}\ntarget = {json.dumps(str(target))}\n"
            f"landmarks = {json.dumps(name + '.json')}\n"
        )
    head = "# Written by docs/studies/shrec07.py\npresets = ['paper', 'standard']\nseeds = [0]\n\n"
    if entries:
        (out / "shrec07.toml").write_text(head + "\n".join(entries))
    return len(entries)


def main(arguments):
    if len(arguments) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    meshes, landmarks, listed, out = map(Path, arguments)
    try:
        n = write(Models(meshes, landmarks), dict.fromkeys(pairs(listed)), out)
    except (Mistake, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    if n == 0:
        print(f"{listed}: no pair", file=sys.stderr)
        return 2
    print(f"{n} pairs: {out / 'shrec07.toml'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
