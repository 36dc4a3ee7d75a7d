"""A training step in PyTorch and in the engine, for interleaved timing."""
import collections
import math
import os
import statistics
import subprocess
import sys
import time

import torch
import torch._dynamo
from torch import nn

from .model import Model, loss_of, windows_of

DROPOUT, CLIP_NORM = 0.2, 1.0

# All settings share their functions' code. After 8 recompilations, the default, PyTorch would run them eagerly without an error.
torch._dynamo.config.recompile_limit = 256
torch._dynamo.config.fail_on_recompile_limit_hit = True


class Setting(collections.namedtuple("Setting", "compiled channels_last threads")):
    def __str__(self):
        return ", ".join(("compiled" if self.compiled else "eager",
                          "channels_last" if self.channels_last else "NCHW",
                          f"{self.threads} thread{'s' * (self.threads > 1)}"))

    @property
    def format(self):
        return torch.channels_last if self.channels_last else torch.contiguous_format

    def applied_to(self, function, **options):
        """Compiled for this number of threads, if at all."""
        return torch.compile(function, dynamic=False, options={"cpp.threads": self.threads, **options}) \
            if self.compiled else function


def all_settings():
    """What is quick to try first."""
    return [Setting(compiled, channels_last, threads) for compiled in (False, True)
            for channels_last in (False, True) for threads in sorted({1, os.cpu_count()})]


class TorchTrainer:
    """Updates as the engine's: drop-out of taxels, clipped gradient, AdamW, a half cosine."""
    device = "cpu"

    def __init__(self, problem, setting):
        self.problem, self.setting, self.options = problem, setting, problem.options
        self.frames, self.batches = problem.frames().to(self.device), [problem.batch(i) for i in range(problem.batches)]
        self.model = Model(problem.spec).to(self.device, memory_format=setting.format)
        self.start()
        self.loss = setting.applied_to(self.loss_of_batch)

    def start(self, weights=None):
        """Starts from `weights`, if given, else from the current ones."""
        if weights:
            self.model.load_state_dict({name: torch.tensor(value) for name, value in weights.items()})
        decayed = [p for p in self.model.parameters() if p.dim() > 1]
        other = [p for p in self.model.parameters() if p.dim() <= 1]
        self.optimizer = torch.optim.AdamW(
            [dict(params=decayed, weight_decay=self.options["weight_decay"]), dict(params=other, weight_decay=0.0)],
            lr=self.options["learning_rate"], fused=True)
        self.updates = 0

    def blanked(self, frames, last_frame, length):
        """Windows of which a share of the taxels is left out, one choice a window."""
        rows, cols = frames.shape[1:]
        keep = (torch.rand(len(last_frame), 1, rows, cols, device=frames.device) >= DROPOUT) / (1 - DROPOUT)
        return windows_of(frames, last_frame, length).mul_(keep).contiguous(memory_format=self.setting.format)

    def loss_of_batch(self, frames, batch):
        spec, segments = self.problem.spec, None
        windows = self.blanked(frames, batch.last_frame, spec["window_frames"])
        if "object" in spec:
            segments = self.blanked(frames, batch.segment_last_frame, spec["segment_frames"])
        return loss_of(self.model(windows, segments, batch.initial_state, self.problem.steps), batch,
                       spec["band_quantile"])

    def set_rate(self, rate):
        for group in self.optimizer.param_groups:
            group["lr"] = rate

    def step(self, batch):
        self.optimizer.zero_grad()
        loss = self.loss(self.frames, batch)
        loss.backward()
        nn.utils.clip_grad_norm_(self.model.parameters(), CLIP_NORM, foreach=True)
        self.optimizer.step()
        return loss

    def update(self):
        progress = self.updates / self.options["updates"]
        self.set_rate(0.5 * self.options["learning_rate"] * (1 + math.cos(math.pi * progress)))
        loss = self.step(self.batches[self.updates % len(self.batches)])
        self.updates += 1
        return loss.item()

    def __call__(self, count):
        """Wall and CPU milliseconds an update, over `count` of them."""
        torch.set_num_threads(self.setting.threads)
        wall, cpu = time.perf_counter(), time.process_time()
        for _ in range(count):
            self.update()
        return [1e3 * (now - then) / count
                for now, then in ((time.perf_counter(), wall), (time.process_time(), cpu))]


class EngineTrainer:
    """Updates by the engine, with a thread per core or with one thread. With `out`, writes the weights there after each call."""

    def __init__(self, engine_step, path, out=None, one_thread=False, device="cpu"):
        self.setting = "1 thread" if one_thread else f"{os.cpu_count()} threads"
        self.process = subprocess.Popen([engine_step, path, "time", *([out] if out else [])], text=True,
                                        env=os.environ | dict(ENGINE_STEP_DEVICE=device) |
                                        (dict(POCL_DEVICES="basic") if one_thread else {}),
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __call__(self, count):
        print(count, file=self.process.stdin, flush=True)
        return [float(word) for word in self.process.stdout.readline().split()]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


WARM_UP = 3  # updates: what PyTorch compiles is not all ready after the first
HOPELESS, CANDIDATE = 4.0, 1.3  # times slower than the best: not timed further, and tried again elsewhere


def try_settings(make, settings, count):
    """make(setting) returns a callable that times `count` turns. Returns pairs of ((wall, CPU) milliseconds, callable)."""
    torch._dynamo.reset()
    tried = []
    for setting in settings:
        try:
            peer = make(setting)
            peer(WARM_UP)
            times = peer(1)
        except Exception as error:  # PyTorch cannot compile this setting here
            print(f"PyTorch {setting}: {type(error).__name__}: {error}", file=sys.stderr)
            continue
        if not tried or times[0] < HOPELESS * min(wall for (wall, _), _ in tried):
            times = [statistics.median(run) for run in zip(*(peer(count) for _ in range(3)))]
        print(f"PyTorch {setting}: {times[0]:.3g} ms, {times[1]:.3g} CPU-ms", file=sys.stderr)
        tried.append((times, peer))
    return tried


def best_of(tried):
    """By wall and by CPU time."""
    return [min(tried, key=lambda entry: entry[0][kind])[1] for kind in (0, 1)]


def candidates(tried):
    """Settings that may be the best of a similar problem."""
    return [peer.setting for times, peer in tried
            if any(times[kind] < CANDIDATE * min(entry[0][kind] for entry in tried) for kind in (0, 1))]


def race(engine_step, problem, folder, peers, rounds, count):
    """For wall and CPU time, each with its peer: the engine's best setting too, and pairs of the peer's and the
    engine's milliseconds an update."""
    path = os.path.join(folder, f"problem{problem.sequences}")
    problem.save(path, {})
    engines = [EngineTrainer(engine_step, path, one_thread=one_thread) for one_thread in (False, True)]
    for engine in engines:
        engine(WARM_UP)
    best = best_of([([statistics.median(run) for run in zip(*(engine(count) for _ in range(3)))], engine)
                    for engine in engines])
    times = [[], []]
    for _ in range(rounds):
        for kind, (peer, engine) in enumerate(zip(peers, best)):
            times[kind].append((peer(count)[kind], engine(count)[kind]))
    for engine in engines:
        engine.close()
    return [(engine.setting, pairs) for engine, pairs in zip(best, times)]
