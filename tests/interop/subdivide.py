#!/usr/bin/env python3
"""Catmull-Clark: a mesh with the same shape and four times the faces a level, its vertices first and in their order.

    subdivide.py IN.obj LEVELS OUT.obj

Landmark files that name vertices stay right. Texture coordinates are dropped.
"""
import sys


def read(path):
    points, faces = [], []
    for line in open(path, errors="replace"):
        word = line.split()
        if word[:1] == ["v"]:
            points.append([float(x) for x in word[1:4]])
        elif word[:1] == ["f"]:
            ids = [int(x.split("/")[0]) for x in word[1:]]
            faces.append([i - 1 if i > 0 else len(points) + i for i in ids])
    return points, faces


def mean(points):
    return [sum(axis) / len(points) for axis in zip(*points)]


def subdivide(points, faces):
    n = len(points)
    centres = [mean([points[v] for v in f]) for f in faces]
    edges = {}
    for row, f in enumerate(faces):
        for a, b in zip(f, f[1:] + f[:1]):
            edges.setdefault((min(a, b), max(a, b)), []).append(row)
    is_inner = {e: len(rows) == 2 for e, rows in edges.items()}
    middle = {e: mean([points[e[0]], points[e[1]]]) for e in edges}
    at_edge = {e: mean([middle[e], mean([centres[r] for r in rows])]) if is_inner[e] else middle[e]
               for e, rows in edges.items()}
    around_faces, around_edges = [[] for _ in points], [[] for _ in points]
    for row, f in enumerate(faces):
        for v in f:
            around_faces[v].append(row)
    for e in edges:
        for v in e:
            around_edges[v].append(e)
    moved = []
    for v, p in enumerate(points):
        rim = [e for e in around_edges[v] if not is_inner[e]]
        if rim:
            moved.append([0.5 * a + 0.5 * b for a, b in zip(p, mean([middle[e] for e in rim]))])
        elif around_faces[v]:
            k = len(around_edges[v])
            f, r = mean([centres[i] for i in around_faces[v]]), mean([middle[e] for e in around_edges[v]])
            moved.append([(a + 2 * b + (k - 3) * c) / k for a, b, c in zip(f, r, p)])
        else:
            moved.append(p)
    row_of = {e: n + i for i, e in enumerate(edges)}
    quads = []
    for row, f in enumerate(faces):
        for k, v in enumerate(f):
            after, before = f[(k + 1) % len(f)], f[k - 1]
            quads.append([v, row_of[min(v, after), max(v, after)], n + len(edges) + row,
                          row_of[min(v, before), max(v, before)]])
    return moved + [at_edge[e] for e in edges] + centres, quads


def main(source, levels, out):
    points, faces = read(source)
    for _ in range(int(levels)):
        points, faces = subdivide(points, faces)
    with open(out, "w") as file:
        file.writelines("v {:.9g} {:.9g} {:.9g}\n".format(*p) for p in points)
        file.writelines("f " + " ".join(str(v + 1) for v in f) + "\n" for f in faces)


main(*sys.argv[1:])
