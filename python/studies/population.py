"""One head over many others on two workers of Dask, one of which is killed on the way: complete, and the bits of a series.

    python studies/population.py [--rows 200] [--iterations 12]
"""

import argparse
import os
import signal
import tempfile
import threading
import time
from pathlib import Path

from distributed import Client, LocalCluster

import mesh_draping as md
from mesh_draping import farm


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("--rows", type=int, default=200)
    args.add_argument("--iterations", type=int, default=12, help="of a drape: what is tried here is the farm")
    args = args.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        targets = write(args)
        began = time.monotonic()
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            lost = threading.Thread(target=kill_one, args=(client, args.rows // 4))
            lost.start()
            done = drape(targets, "farm", farm.batch, client=client)
            lost.join()
        print(f"{len(done.rows)} rows by two workers, one killed: {time.monotonic() - began:.0f} s")
        print(f"    {sum(row['error'] is None for row in done.rows)} of {args.rows} draped")
        began = time.monotonic()
        drape(targets, "series", series)
        print(f"in series: {time.monotonic() - began:.0f} s")
        names = [Path(target).stem + ".obj" for target in targets]
        same = [Path("farm", name).read_bytes() == Path("series", name).read_bytes() for name in names]
        print(f"    {sum(same)} of {args.rows} results of the same bits")


def write(args):
    Path("short.toml").write_text(f'preset = "quick"\ninitial = "standard"\n[[stages]]\nn_iterations = {args.iterations}\n')
    for seed in range(args.rows):
        pair = md.bench.write(Path(str(seed)), "head", seed, angle=20, ratio=1.2, landmarks=6)
        (pair / "target.ply").rename(f"scan{seed:03}.ply")
        (pair / "landmarks.json").rename(f"scan{seed:03}.json")
    Path("0/source.obj").rename("head.obj")
    return [f"scan{seed:03}.ply" for seed in range(args.rows)]


def drape(targets, folder, batch, **more):
    return batch(
        "head.obj", targets, folder + "/{target}.obj",
        landmarks="{target}.json", summary=folder, options=["--config", "short.toml"], **more,
    )  # fmt: skip


def series(*arguments, **options):
    """The same without Dask."""
    line = farm.command(*arguments, **options)
    farm._run(["--threads", "1", *line.arguments], line.folder)


def kill_one(client, n_before):
    """Ends a worker for good when so many rows are there."""
    while len(list(Path("farm").glob("*.obj"))) < n_before:
        time.sleep(0.05)
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)


if __name__ == "__main__":
    main()
