"""What the results of a population are worth to the next drape: truth with and without `--prior`, on whole targets and on scans
of one side, with many landmarks and with few.

    python studies/prior.py [--solved 8] [--tried 3] [--landmarks 16 5] [--variants mesh half-scan] [--plan head] [--drape drape]

The solved ones are whole and have 16 landmarks each.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import mesh_draping as md

#: Individuals that are tried are counted from here: none of them is among the solved.
FIRST_TRIED = 100


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--solved", type=int, default=8)
    args.add_argument("--tried", type=int, default=3)
    args.add_argument("--landmarks", type=int, nargs="+", default=[16, 5])
    args.add_argument("--variants", nargs="+", default=["mesh", "half-scan"], choices=md.bench.VARIANTS)
    args.add_argument("--plan", default="head", choices=md.bench.PLANS)
    args.add_argument("--angle", type=float, default=20.0, help="largest turn of a joint, in degrees")
    args.add_argument("--ratio", type=float, default=1.5, help="largest ratio of lengths")
    args.add_argument("--preset", default="quick")
    args.add_argument("--drape", default="drape", help="the command")
    args = args.parse_args()
    args.drape = os.path.abspath(args.drape) if os.sep in args.drape else args.drape
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("solved").mkdir()
        for seed in range(args.solved):
            truth(args, pair(args, seed, 16, "mesh"), f"solved/{seed}.obj")
        print(f"{args.plan}, {args.solved} solved, {args.tried} tried, preset {args.preset}: truth %, with and without")
        for variant in args.variants:
            for landmarks in args.landmarks:
                told(args, variant, landmarks)


def told(args, variant, landmarks):
    """Drapes with and without the prior, and prints a line."""
    folders = [pair(args, FIRST_TRIED + k, landmarks, variant) for k in range(args.tried)]
    alone, led = (
        np.array([truth(args, folder, "out.obj", *options) for folder in folders])
        for options in ((), ("--prior", "solved"))
    )
    better = (led[:, 0] < alone[:, 0]).sum()
    print(
        f"{variant:10} {landmarks:3} landmarks: {led[:, 0].mean():.3f} and {alone[:, 0].mean():.3f}, better on {better} of "
        f"{args.tried}; CPU-s {led[:, 1].mean():.1f} and {alone[:, 1].mean():.1f}",
        flush=True,
    )


def pair(args, seed, landmarks, variant):
    folder = Path(f"{seed}-{landmarks}-{variant}")
    dial = {"angle": args.angle, "ratio": args.ratio, "landmarks": landmarks, "variant": variant}
    return md.bench.write(folder, args.plan, seed, **dial)


def truth(args, folder, output, *options):
    """Mean distance to the true places in percent of the longest side, and CPU-seconds."""
    line = [args.drape, "--threads", "1", "transfer", folder / "source.obj", folder / "target.ply"]
    line += ["-l", folder / "landmarks.json", "--preset", args.preset, "-o", output, "--json", *options]
    done = subprocess.run(line, check=True, capture_output=True, text=True)
    right = np.load(folder / "truth.npy")
    off = np.linalg.norm(vertices(Path(output)) - right, axis=1).mean()
    return 100 * off / np.ptp(right, axis=0).max(), json.loads(done.stdout)["figures"]["cpu_seconds"]


def vertices(path):
    lines = (line.split() for line in path.read_text().splitlines())
    return np.array([[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]])


if __name__ == "__main__":
    main()
