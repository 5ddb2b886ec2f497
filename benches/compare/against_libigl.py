#!/usr/bin/env python3
"""libigl on the same meshes and queries: run `cargo run --release -- write FOLDER` first.

    pip install numpy scipy libigl
    against_libigl.py FOLDER

Medians of five, on as many threads as libigl takes (taskset -c 0 for one).
"""
import sys
import time

import igl
import numpy as np


def median(work):
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return sorted(seconds)[2]


def mesh(folder, n):
    vertices = np.fromfile(f"{folder}/{n}.v").reshape(-1, 3)
    faces = np.fromfile(f"{folder}/{n}.f", "<u4").reshape(-1, 3).astype(np.int64)
    return vertices, faces


def main(folder):
    for n in (29, 91, 289):
        vertices, faces = mesh(folder, n)
        queries = np.fromfile(f"{folder}/{n}.q").reshape(-1, 3)
        tree = igl.AABB()
        build = median(lambda: tree.init(vertices, faces))
        seconds = median(lambda: tree.squared_distance(vertices, faces, queries))
        print(f"closest {len(faces)} triangles: libigl {seconds:.4f} s, build {build:.4f} s", flush=True)
    for n in (91, 183):
        vertices, faces = mesh(folder, n)
        held = np.arange(0, len(vertices), len(vertices) // 16)
        values = np.repeat(held[:, None].astype(float), 3, 1)
        seconds = median(lambda: igl.harmonic(vertices, faces, held, values, 2))
        print(f"biharmonic {len(vertices)} vertices: libigl {seconds:.3f} s", flush=True)


main(sys.argv[1])
