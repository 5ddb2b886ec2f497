"""A creature in motion, draped frame by frame and as a sequence: jitter, truth and time beside each other.

    python studies/motion.py [--frames 60] [--plan quadruped] [--preset quick] [--drape drape]

Jitter is the mean length of the second difference of the error over time: what trembles although the truth does not.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import mesh_draping as md


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--frames", type=int, default=60)
    args.add_argument("--plan", default="quadruped", choices=md.bench.PLANS)
    args.add_argument("--angle", type=float, default=60.0, help="largest turn of a joint on the way, in degrees")
    args.add_argument("--preset", default="quick")
    args.add_argument("--drape", default="drape", help="the command")
    args = args.parse_args()
    args.drape = os.path.abspath(args.drape) if os.sep in args.drape else args.drape
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        truth = write_frames(args)
        print(f"{args.plan}, {args.frames} frames, {args.angle:g} degrees, preset {args.preset}, {truth.shape[1]} vertices")
        print("                              truth %   jitter %   CPU-s a frame")
        every, first = "marks/{target}.json", "first/{target}.json"
        led = told(args, "sequence", truth, every, ["--sequence"])
        freed = told(args, "sequence, first marked", truth, first, ["--sequence"])
        alone = told(args, "frame by frame", truth, every, [])
        for name, figures in (("sequence", led), ("sequence, first marked", freed)):
            shares = "  ".join(f"{b / a:9.2f}" for a, b in zip(alone, figures))
            print(f"{name + ', of the last':34}{shares}")


def write_frames(args):
    """The frames as files, landmarks of every one and of the first alone; where each vertex truly belongs."""
    truth = []
    for row, frame in enumerate(md.bench.motion(args.plan, 0, args.frames, angle=args.angle)):
        write_obj(f"{row:03}.obj", *frame.target)
        write_marks("marks", row, frame.landmarks)
        if row == 0:
            write_obj("source.obj", *frame.source)
            write_marks("first", row, frame.landmarks)
        truth.append(frame.truth)
    return np.array(truth)


def write_marks(folder, row, landmarks):
    Path(folder).mkdir(exist_ok=True)
    Path(folder, f"{row:03}.json").write_text(json.dumps({"landmarks": landmarks}))


def write_obj(path, vertices, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in map(list, faces)]
    Path(path).write_text("\n".join(lines) + "\n")


def told(args, name, truth, marks, options):
    """Drapes all frames, and prints a line; its three figures."""
    folder = name.replace(" ", "_").replace(",", "")
    targets = [f"{row:03}.obj" for row in range(len(truth))]
    line = [args.drape, "--threads", "1", "batch", "source.obj", *targets, "-l", marks, "-o", folder + "/{target}.obj"]
    line += ["--summary", folder, "--preset", args.preset, *options]
    subprocess.run(line, check=True, capture_output=True)
    rows = json.loads(Path(folder, "results.json").read_text())
    found = np.array([vertices(Path(folder, target)) for target in targets])
    side = np.ptp(truth[0], axis=0).max()
    error = (found - truth) / side
    off = 100 * np.linalg.norm(error, axis=2).mean()
    jitter = 100 * np.linalg.norm(error[2:] - 2 * error[1:-1] + error[:-2], axis=2).mean()
    # The first frame of a sequence is a drape like any other.
    seconds = float(np.mean([row["figures"]["cpu_seconds"] for row in rows[1:]]))
    print(f"{name:28}{off:9.3f}  {jitter:9.3f}  {seconds:14.2f}", flush=True)
    return off, jitter, seconds


def vertices(path):
    lines = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]])


if __name__ == "__main__":
    main()
