"""Thousands of scans: one mesh draped over many targets, by the workers of Dask.

    from dask.distributed import Client
    import mesh_draping.farm as farm

    done = farm.batch("head.obj", sorted(scans.glob("*.ply")), "out/{target}.obj",
                      landmarks="marks/{target}.json", client=Client("tcp://scheduler:8786"))

The scheduler may stand on this machine (``Client()``), or be one of ``dask-jobqueue`` for Slurm, PBS, SGE or LSF. Every
target is a task of its own, and each task is the command ``drape batch … --shard K/N`` in a process of its own: the same
bits as in series. A worker that is lost loses only the target that it was at, which another does again; what is done is
not done again, now or when the same call is made another day: the caller looks once what is left. Workers see the files at
the same paths as the caller, and read the list of targets from the folder of tables.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Iterable, List, NamedTuple, Optional, Union

PathLike = Union[str, "os.PathLike[str]"]

#: A target is tried on this many workers before it counts as failed.
TRIES = 4
#: What `drape batch` ends with where not all could be draped: the table tells which and why.
NOT_ALL = 2


class Done(NamedTuple):
    """What came of a batch."""

    rows: "List[dict[str, Any]]"
    """A row per target, in their order: pair, error (None where there is a result), figures, warnings, output."""
    table: Path
    """The same as CSV."""
    page: Path
    """The same as a page with pictures."""


def batch(
    source: PathLike,
    targets: Iterable[PathLike],
    output: str,
    *,
    landmarks: Optional[str] = None,
    summary: PathLike = "drape-batch",
    options: Iterable[str] = (),
    client: Any = None,
    threads: int = 1,
) -> Done:
    """Drapes ``source`` over every target, and writes one table and one page.

    ``output``, ``landmarks``: patterns with ``{target}``, ``{folder}`` and ``{source}`` in the place of names.
    ``summary``: the folder of tables and of what is done already.
    ``options``: further options of ``drape batch``, such as ``["--preset", "quick", "--overlap", "full"]``.
    ``client``: of Dask; one of this machine's processors where none is given.
    ``threads``: of each run: as many as a worker has processors for each of its own threads.
    """
    from dask.distributed import Client

    line = command(source, targets, output, landmarks=landmarks, summary=summary, options=options)
    left = _left(line)
    if client is not None:
        _drape_all(client, line, left, threads)
    elif left:
        with Client(processes=True) as own:
            _drape_all(own, line, left, threads)
    return _gathered(line, Path(line.folder) / line.summary)


class Line(NamedTuple):
    """A command line of ``drape batch``, and where it is given."""

    arguments: "List[str]"
    summary: str
    n_targets: int
    folder: str

    def shard(self, k: int) -> "List[str]":
        """The arguments of the K-th part, counted from 1: one target."""
        return [*self.arguments, f"--shard={k}/{self.n_targets}"]


def command(
    source: PathLike,
    targets: Iterable[PathLike],
    output: str,
    *,
    landmarks: Optional[str] = None,
    summary: PathLike = "drape-batch",
    options: Iterable[str] = (),
) -> Line:
    """The command line of a batch, as :func:`batch` gives it to its workers; the file ``targets.txt`` in the folder of tables
    names the targets."""
    paths = [os.fspath(target) for target in targets]
    listed = Path(summary, "targets.txt")
    listed.parent.mkdir(parents=True, exist_ok=True)
    listed.write_text("".join(path + "\n" for path in paths))
    arguments = ["batch", os.fspath(source), "--targets-from", str(listed)]
    arguments += ["--output", output, "--summary", os.fspath(summary)]
    if landmarks is not None:
        arguments += ["--landmarks", landmarks]
    return Line([*arguments, *options], os.fspath(summary), len(paths), os.getcwd())


def _left(line: Line) -> "List[int]":
    """The numbers of the targets that are not done yet, counted from 1."""
    return [int(number) for number in _run([*line.arguments, "--left"], line.folder).split()]


def _drape_all(client: Any, line: Line, left: "List[int]", threads: int) -> None:
    """One task per target that is left; a task whose worker is lost is given to another."""
    from dask.distributed import as_completed

    # Not by content: a call that is made again looks again at what is done.
    tasks = client.map(
        _drape_one,
        [(line, k, threads) for k in left],
        pure=False,
        retries=TRIES,
    )
    for task in as_completed(tasks):
        task.result()
        task.release()


def _drape_one(job: "tuple[Line, int, int]") -> None:
    """A target, on the worker that this is called on."""
    line, k, threads = job
    _run(["--threads", str(threads), *line.shard(k)], line.folder)


def _gathered(line: Line, summary: Path) -> Done:
    """The table and the page of all rows; what failed is tried once more, here."""
    _run(line.arguments, line.folder)
    rows = json.loads((summary / "results.json").read_text())
    return Done(rows, summary / "results.csv", summary / "index.html")


def _run(arguments: "List[str]", folder: str) -> str:
    """The command in a process of its own, which goes where this one goes; what it printed."""
    line = [sys.executable, "-m", "mesh_draping", *arguments]
    ended = subprocess.run(line, cwd=folder, capture_output=True, text=True)
    if ended.returncode not in (0, NOT_ALL):
        raise RuntimeError(ended.stderr.strip() or f"drape ended with {ended.returncode}")
    return ended.stdout
