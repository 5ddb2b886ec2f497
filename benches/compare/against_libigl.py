#!/usr/bin/env python3
"""libigl on the same meshes and queries: run `cargo run --release -- write FOLDER` first.

    pip install numpy scipy libigl
    against_libigl.py FOLDER

Medians of five; closest points on one thread (taskset -c 0) and in two processes with half of the queries each, since
libigl asks its tree one query after the other. The biharmonic field of the larger mesh is solved once.
"""
import multiprocessing
import sys
import time

import igl
import numpy as np


def median(work, n_turns=5):
    seconds = []
    for _ in range(n_turns):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return sorted(seconds)[n_turns // 2]


def mesh(folder, n):
    vertices = np.fromfile(f"{folder}/{n}.v").reshape(-1, 3)
    faces = np.fromfile(f"{folder}/{n}.f", "<u4").reshape(-1, 3).astype(np.int64)
    return vertices, faces


def in_two(tree, vertices, faces, queries):
    """Seconds until both halves are answered, from when both processes are ready."""
    fork = multiprocessing.get_context("fork")
    barrier = fork.Barrier(3)

    def work(half):
        barrier.wait()
        tree.squared_distance(vertices, faces, half)
        barrier.wait()

    workers = [fork.Process(target=work, args=(half,)) for half in np.array_split(queries, 2)]
    for worker in workers:
        worker.start()
    barrier.wait()
    start = time.perf_counter()
    barrier.wait()
    seconds = time.perf_counter() - start
    for worker in workers:
        worker.join()
    return seconds


def main(folder):
    for n in (29, 91, 289):
        vertices, faces = mesh(folder, n)
        queries = np.fromfile(f"{folder}/{n}.q").reshape(-1, 3)
        tree = igl.AABB()
        build = median(lambda: tree.init(vertices, faces))
        seconds = median(lambda: tree.squared_distance(vertices, faces, queries))
        both = sorted(in_two(tree, vertices, faces, queries) for _ in range(5))[2]
        print(
            f"closest {len(faces)} triangles: libigl {seconds:.4f} s, in two processes {both:.4f} s, build {build:.4f} s",
            flush=True,
        )
    for n, n_turns in ((91, 5), (183, 1)):
        vertices, faces = mesh(folder, n)
        held = np.arange(0, len(vertices), len(vertices) // 16)
        values = np.repeat(held[:, None].astype(float), 3, 1)
        seconds = median(lambda: igl.harmonic(vertices, faces, held, values, 2), n_turns)
        print(f"biharmonic {len(vertices)} vertices: libigl {seconds:.3f} s", flush=True)


main(sys.argv[1])
