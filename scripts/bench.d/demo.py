# The main job over several seeds: mean and spread of its table, and whether touch pays for itself in each.
# needs: numpy
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np

import figures
from figures import row

METRICS = {"l1_at_20": "L1@20", "l1_at_50": "L1@50", "hausdorff": "Hausdorff", "coverage": "coverage"}
MODELS = ["full", "without_touch", "random"]


def run_demo(seed, folder, rest):
    """Runs scripts/demo and keeps its metrics and report only: recordings of many seeds would fill the disk."""
    work = folder / "work"
    started = time.monotonic()
    subprocess.run(["scripts/demo", "--seed", str(seed), "--output", str(work), *rest], check=True, stdout=sys.stderr)
    seconds = time.monotonic() - started
    metrics = json.loads((work / "metrics.json").read_text())
    for name in ("metrics.json", "report.html"):
        shutil.copy(work / name, folder / f"seed{seed}.{name}")
    shutil.rmtree(work)
    return metrics["results"], seconds


def rows_of(results, seconds):
    """`results`: for each seed the rows of metrics.json."""
    rows = []
    for activity in sorted({row["activity"] for seed in results for row in seed}):
        table = {(model, metric): np.array([row[metric] for seed in results for row in seed
                                            if row["activity"] == activity and row["model"] == model], float)
                 for model in MODELS for metric in METRICS if not (model == "random" and metric == "coverage")}
        for (model, metric), values in table.items():
            rows.append(row(f"{activity} {model} {METRICS[metric]}, mean", values.mean(), "", seconds=seconds))
            rows.append(row(f"{activity} {model} {METRICS[metric]}, standard deviation", values.std(ddof=1), ""))
        for metric in ("l1_at_20", "l1_at_50"):
            full, blind, random = (table[model, metric] for model in MODELS)
            worst = max((full / blind).max(), (blind / random).max())
            rows.append(row(f"{activity} {METRICS[metric]}: worst of Full / w/o Touch / Random", worst, "ratio", "< 1", worst < 1))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("out/bench/demo"))
    options, rest = parser.parse_known_args()
    options.output.mkdir(parents=True, exist_ok=True)
    results, seconds = zip(*(run_demo(seed, options.output, rest) for seed in options.seeds))
    rows = rows_of(results, float(np.mean(seconds)))
    rows.append(row("seconds of scripts/demo, worst", max(seconds), "s", "<= 600", max(seconds) <= 600))
    return figures.emit(rows, 52, as_json=True)


sys.exit(main())
