# The engine against PyTorch: the same loss and gradients in double; a training step, an online step and
# the error over the time of training, interleaved in one run.
# needs: torch numpy safetensors
import argparse
import itertools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

# PyTorch at its best: memory is kept instead of being given back and faulted in again at every step, and what
# it compiles is kept for the next run. Both must be set before it starts.
ENVIRONMENT = dict(MALLOC_ARENA_MAX="1", MALLOC_MMAP_MAX_="0", MALLOC_TOP_PAD_=str(1 << 28),
                   MALLOC_TRIM_THRESHOLD_=str(1 << 33), TORCHINDUCTOR_CACHE_DIR="build/bench/engine/inductor")
if __name__ == "__main__" and any(os.environ.get(key) != value for key, value in ENVIRONMENT.items()):
    os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ENVIRONMENT})

import numpy as np
import torch

from figures import at_most, emit, row
from torch_twin.comparison import compare
from torch_twin.course import Course, picture_of, settled, time_until
from torch_twin.cuda import CudaSetting, CudaTrainer
from torch_twin.model import BOTH_ENCODERS, ONE_ENCODER, OTHER_CONVOLUTIONS, Model
from torch_twin.online import EngineOnline, best_online, busy_core, distance
from torch_twin.problem import noise_problem, weights_of
from torch_twin.training import WARM_UP, EngineTrainer, TorchTrainer, all_settings, best_of, candidates, race, try_settings

PEER = f"PyTorch {torch.__version__}"


def ratio(name, peer, ratios, goal, **rest):
    """Median of the ratios of the peer's time to the engine's, one of each alternating run."""
    middle = statistics.median(ratios)
    return row(f"{name}: {PEER} ({peer}) / engine, {min(ratios):.2f} .. {max(ratios):.2f}", middle, "x",
               f">= {goal:g}", middle >= goal, **rest)


def comparison_figures(options, folder):
    for name, spec, sequences in (("one encoder", ONE_ENCODER, 1), ("both encoders", BOTH_ENCODERS, 3),
                                  ("5 x 5 taps, strides 1, 2, 1", OTHER_CONVOLUTIONS, 1),
                                  ("SiLU, Q = 0.25", dict(ONE_ENCODER, activation="silu", band_quantile=0.25), 1),
                                  ("tanh", dict(ONE_ENCODER, activation="tanh"), 1),
                                  ("GRU", dict(ONE_ENCODER, dynamics="gru"), 2),
                                  ("GRU, both encoders", dict(BOTH_ENCODERS, dynamics="gru"), 3)):
        start = time.time()
        loss, gradient = compare(options.engine_step, folder, spec, sequences, options.seed)
        yield at_most(f"whole model, {name}, loss against PyTorch in double", loss, "relative", 1e-5,
                      seconds=time.time() - start)
        yield at_most(f"whole model, {name}, gradient against PyTorch in double", gradient, "relative", 1e-5)


def step_figures(options, folder):
    """All settings of PyTorch are tried on the first problem, and those near its best on the others."""
    settings = options.settings
    for encoders, spec in (("both encoders", BOTH_ENCODERS), ("one encoder", ONE_ENCODER)):
        for sequences, goal in ((8, 2.0), (32, 1.7)):
            start, name = time.time(), f"training step, {sequences} sequences, {encoders}"
            print(name, file=sys.stderr)
            problem, count = noise_problem(spec, sequences, options.seed), max(2, options.count * 8 // sequences)
            tried = try_settings(lambda setting: TorchTrainer(problem, setting), settings, max(2, count // 4))
            settings, peers = candidates(tried), best_of(tried)
            times = race(options.engine_step, problem, folder, peers, options.rounds, count)
            for kind, peer, (setting, pairs) in zip(("wall", "CPU"), peers, times):
                yield ratio(f"{name}, {kind} time, engine with {setting}", peer.setting,
                            [theirs / ours for theirs, ours in pairs], goal, seconds=time.time() - start)
                yield row(f"{name}, {kind} time, engine", statistics.median(ours for _, ours in pairs), "ms")
    options.candidates = settings


def online_figures(options, folder):
    start = time.time()
    problem, model = noise_problem(ONE_ENCODER, 1, options.seed), Model(ONE_ENCODER)
    path = os.path.join(folder, "online")
    problem.save(path, weights_of(model))
    peer = best_online(problem, model, options.settings, options.online_count)
    engine = EngineOnline(options.engine_step, path)
    sides = (peer, engine)
    for side in sides:
        side(options.online_count)
    medians = np.array([[statistics.median(side(options.online_count)) for side in sides]
                        for _ in range(options.rounds)])
    yield ratio("online step, median", peer.name, list(medians[:, 0] / medians[:, 1]), 3.0, seconds=time.time() - start)
    yield row("online step, median, engine", np.median(medians[:, 1]), "us")
    with busy_core():
        times = [np.concatenate([side(options.online_count) for _ in range(options.rounds)]) for side in (engine, peer)]
    yield at_most("online step with a busy core, 99th percentile, engine", np.percentile(times[0], 99), "us", 1000)
    yield row("online step with a busy core, 99th percentile, PyTorch", np.percentile(times[1], 99), "us")
    yield at_most("online step, state and spread against PyTorch", distance(engine, peer), "relative", 1e-5)
    engine.close()


def course_figures(options, folder):
    start = time.time()
    problem = noise_problem(ONE_ENCODER, 8, options.seed)
    setting = best_of(try_settings(lambda s: TorchTrainer(problem, s), options.candidates, 5))[0].setting
    runs = [Course(options, folder, setting, options.seed + i).run(options.updates) for i in range(options.courses)]
    for kind, name in enumerate(("wall", "CPU")):
        times = [[time_until(curve, kind, settled(curves)) for curve in curves] for curves in runs]
        yield ratio(f"training to the same validation error, {name} time", setting, [b / a for a, b in times], 2.0,
                    seconds=time.time() - start, picture=picture_of(runs[0], kind, f"{PEER}, {setting}"))
        yield row(f"training to the same validation error, {name} time, engine",
                  statistics.median(ours for ours, _ in times), "s")
    for side, name in enumerate(("engine", "PyTorch")):
        yield row(f"best validation error, {name}", statistics.median(c[side][:, 2].min() for c in runs), "deviation")


def engine_has_gpu(options):
    devices = subprocess.run([options.touchtrace, "devices", "--json"], capture_output=True, text=True, check=True)
    return any(device["type"] == "gpu" for device in json.loads(devices.stdout)["devices"])


def gpu_figures(options, folder):
    """The training step on a GPU that both PyTorch and the engine can use, reported without a goal."""
    if not (torch.cuda.is_available() and engine_has_gpu(options)):
        print("gpu: no GPU offers both CUDA to PyTorch and OpenCL to the engine", file=sys.stderr)
        return
    for dynamics, sequences in itertools.product(("mlp", "gru"), (8, 32)):
        problem = noise_problem(dict(BOTH_ENCODERS, dynamics=dynamics), sequences, options.seed)
        path = os.path.join(folder, "gpu")
        problem.save(path, {})
        engine = EngineTrainer(options.engine_step, path, device="gpu")
        engine(WARM_UP)
        name = f"training step on a GPU, {dynamics.upper()}, {sequences} sequences, both encoders"
        for graph in (False, True):
            start = time.time()
            settings = [CudaSetting(graph, *rest) for rest in
                        itertools.product((False,) if options.eager else (False, True), (False, True))]
            tried = try_settings(lambda setting: CudaTrainer(problem, setting), settings, options.count)
            if not tried:
                continue
            peer = best_of(tried)[0]
            pairs = [(peer(options.count)[0], engine(options.count)[0]) for _ in range(options.rounds)]
            ratios = [theirs / ours for theirs, ours in pairs]
            yield row(f"{name}: {PEER} ({peer.setting}) / engine, {min(ratios):.2f} .. {max(ratios):.2f}",
                      statistics.median(ratios), "x", seconds=time.time() - start)
            yield row(f"{name}, engine", statistics.median(ours for _, ours in pairs), "ms")
        engine.close()


FIGURES = dict(comparison=comparison_figures, step=step_figures, online=online_figures, course=course_figures,
               gpu=gpu_figures)


def parse_arguments():
    parser = argparse.ArgumentParser(prog="scripts/bench engine", description="the engine against PyTorch")
    parser.add_argument("--engine-step", default="build/release/tests/engine_step")
    parser.add_argument("--study-course", default="build/release/tests/study_course")
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--cache", type=pathlib.Path, default=pathlib.Path("build/bench/engine/wave"),
                        help="folder for the labelled wave of `course`")
    parser.add_argument("--figures", nargs="+", choices=FIGURES, default=list(FIGURES), help="which of them")
    parser.add_argument("--rounds", type=int, default=7, help="alternating runs of a timing")
    parser.add_argument("--count", type=int, default=20, help="updates a run at 8 sequences")
    parser.add_argument("--online-count", type=int, default=1000, help="online steps a run")
    parser.add_argument("--updates", type=int, default=800, help="of a training in `course`")
    parser.add_argument("--courses", type=int, default=2, help="trainings in `course`")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="of all inputs")
    parser.add_argument("--eager", action="store_true", help="do not try torch.compile")
    parser.add_argument("--json", action="store_true", help="print all rows as one JSON object")
    options = parser.parse_args()
    for program in (options.engine_step, options.study_course, options.touchtrace):
        if not os.access(program, os.X_OK):
            parser.error(f"{program} is missing: run cmake --preset release && cmake --build --preset release")
    options.cache.mkdir(parents=True, exist_ok=True)
    options.settings = [setting for setting in all_settings() if not (options.eager and setting.compiled)]
    options.candidates = options.settings
    return options


def main():
    options = parse_arguments()
    print(f"seed {options.seed}", file=sys.stderr)
    torch.manual_seed(options.seed)
    torch.set_flush_denormal(True)
    warnings.filterwarnings("ignore")  # TorchScript is deprecated, and still the fastest at batch 1
    with tempfile.TemporaryDirectory() as folder:
        return emit((row for figure in options.figures for row in FIGURES[figure](options, folder)), 124, options.json)


if __name__ == "__main__":
    sys.exit(main())
