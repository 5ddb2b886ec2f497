#!/usr/bin/env python3
"""libigl on the same meshes and queries: run `cargo run --release -- write FOLDER` first.

    pip install numpy scipy libigl
    against_libigl.py FOLDER

Seconds and CPU-seconds, the middle of five; on as many threads as libigl takes (taskset -c 0 for one). The larger
biharmonic field is solved once.
"""
import sys
import time

import igl
import numpy as np


def median(work, n_turns=5):
    seconds = []
    for _ in range(n_turns):
        start, cpu = time.perf_counter(), time.process_time()
        work()
        seconds.append((time.perf_counter() - start, time.process_time() - cpu))
    return "{:.3f} s ({:.3f} CPU-s)".format(*sorted(seconds)[n_turns // 2])


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
        print(f"closest {len(faces)} triangles: libigl {seconds}, build {build}", flush=True)
    for n, n_turns in ((91, 5), (183, 1)):
        vertices, faces = mesh(folder, n)
        held = np.arange(0, len(vertices), len(vertices) // 16)
        values = np.repeat(held[:, None].astype(float), 3, 1)
        seconds = median(lambda: igl.harmonic(vertices, faces, held, values, 2), n_turns)
        print(f"biharmonic {len(vertices)} vertices: libigl {seconds}", flush=True)


main(sys.argv[1])
