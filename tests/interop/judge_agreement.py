#!/usr/bin/env python3
"""Holds `drape metrics` against an independent judge, on finished results. Not part of the test run.

    python3 -m venv venv && venv/bin/pip install numpy scipy libigl
    cargo build --release -p drape-cli
    venv/bin/python tests/interop/judge_agreement.py JUDGE PAIRS RESULTS [NAME...]

JUDGE is the judge's Python file (it has a function `evaluate`), PAIRS a folder of pairs
(NAME/source.obj, NAME/target.obj, NAME/landmarks.json, and NAME/gt_source_on_target.ply where the truth is known),
RESULTS a folder with NAME.obj or NAME/draped.obj for each pair to compare. Exit code 1 where the two disagree.

The judge cuts a polygon with five or more sides as a fan and does not see that a quad is concave; on sources that have
such faces counts may differ by those faces.
"""
import importlib.util
import json
import pathlib
import subprocess
import sys

DRAPE = pathlib.Path(__file__).resolve().parents[2] / "target/release/drape"
TOLERANCES = dict(q_transfer=0.003, dirichlet=0.001, hausdorff=0.001, mean_l2_sum=0.0005, folds=0, skinny=0,
                  skinny_new=0, landmark_rms=1e-6, landmark_max=1e-6, truth_mean=1e-6, truth_max=1e-6)


def result_of(folder, name):
    candidates = [folder / f"{name}.obj", folder / name / "draped.obj"]
    return next((path for path in candidates if path.exists()), None)


def ours(pair, result, truth):
    command = [DRAPE, "metrics", pair / "source.obj", result, pair / "target.obj", "--landmarks", pair / "landmarks.json", "--json"]
    command += ["--truth", truth] if truth else []
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["figures"]


def main(judge_path, pairs, results, *names):
    spec = importlib.util.spec_from_file_location("judge", judge_path)
    judge = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(judge)
    pairs, results = pathlib.Path(pairs), pathlib.Path(results)
    names = names or sorted(path.name for path in pairs.iterdir() if result_of(results, path.name))
    n_different = 0
    print(f"{'pair':26}" + "".join(f"{key:>22}" for key in ["q_transfer", "hausdorff", "folds", "skinny"]) + "  disagree")
    for name in names:
        pair, result = pairs / name, result_of(results, name)
        if result is None:
            sys.exit(f"{results}: no result for {name}; expected {name}.obj or {name}/draped.obj")
        truth = pair / "gt_source_on_target.ply"
        truth = str(truth) if truth.exists() else None
        theirs = judge.evaluate(str(pair / "source.obj"), str(result), str(pair / "target.obj"),
                                str(pair / "landmarks.json"), truth)
        mine = ours(pair, result, truth)
        different = [key for key, slack in TOLERANCES.items() if key in theirs and abs(theirs[key] - mine[key]) > slack]
        n_different += bool(different)
        columns = "".join(f"{theirs[key]:11.4f}{mine[key]:11.4f}" for key in ["q_transfer", "hausdorff"])
        columns += "".join(f"{theirs[key]:11.0f}{mine[key]:11.0f}" for key in ["folds", "skinny"])
        print(f"{name:26}{columns}  {', '.join(different) or '-'}", flush=True)
    if not names:
        sys.exit(f"{results}: no result to compare")
    sys.exit(1 if n_different else 0)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
