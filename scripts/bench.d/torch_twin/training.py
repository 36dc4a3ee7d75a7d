"""A training step in PyTorch and in the engine, to be timed in turns."""
import collections
import math
import os
import statistics
import subprocess
import sys
import time

import torch
from torch import nn

from .model import SPEC, Model, loss_of, windows_of

DROPOUT, CLIP_NORM = 0.2, 1.0
# What Trainer takes where a problem's options say nothing (engine/train/trainer.h).
DEFAULTS = dict(updates=3000, learning_rate=2e-3, weight_decay=0.1)


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

    def __init__(self, problem, setting):
        self.problem, self.setting = problem, setting
        self.options = {**DEFAULTS, **problem.options}
        self.frames, self.batches = problem.frames(), [problem.batch(i) for i in range(problem.batches)]
        self.model = Model().to(memory_format=setting.format)
        self.start()
        self.loss = setting.applied_to(self.loss_of_batch)

    def start(self, weights=None):
        """Begins anew, from given weights if there are any."""
        if weights:
            self.model.load_state_dict({name: torch.tensor(value) for name, value in weights.items()})
        decayed = [p for p in self.model.parameters() if p.dim() > 1]
        other = [p for p in self.model.parameters() if p.dim() <= 1]
        self.optimizer = torch.optim.AdamW(
            [dict(params=decayed, weight_decay=self.options["weight_decay"]), dict(params=other, weight_decay=0.0)],
            lr=self.options["learning_rate"], fused=True)
        self.updates = 0

    def loss_of_batch(self, frames, last, initial, target, weight):
        keep = (torch.rand(len(last), 1, SPEC["rows"], SPEC["cols"]) >= DROPOUT) / (1 - DROPOUT)
        windows = windows_of(frames, last).mul_(keep).contiguous(memory_format=self.setting.format)
        return loss_of(*self.model(windows, initial, self.problem.steps), target, weight)

    def update(self):
        rate = 0.5 * self.options["learning_rate"] * (1 + math.cos(math.pi * self.updates / self.options["updates"]))
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        self.optimizer.zero_grad()
        loss = self.loss(self.frames, *self.batches[self.updates % len(self.batches)])
        loss.backward()
        nn.utils.clip_grad_norm_(self.model.parameters(), CLIP_NORM, foreach=True)
        self.optimizer.step()
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
    """The same of the engine; with `out`, weights are written there after every call."""

    def __init__(self, engine_step, path, out=None):
        self.process = subprocess.Popen([engine_step, path, "time", *([out] if out else [])], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __call__(self, count):
        print(count, file=self.process.stdin, flush=True)
        return [float(word) for word in self.process.stdout.readline().split()]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def best_peers(make, settings, count):
    """make(setting) -> something that times `count` turns. The fastest by wall and by CPU time."""
    seen = []
    for setting in settings:
        try:
            peer = make(setting)
            peer(2)
        except Exception as error:  # a setting that PyTorch cannot compile here is no peer
            print(f"PyTorch {setting}: {type(error).__name__}: {error}", file=sys.stderr)
            continue
        times = [statistics.median(run) for run in zip(*(peer(count) for _ in range(3)))]
        print(f"PyTorch {setting}: {times[0]:.3g} ms, {times[1]:.3g} CPU-ms", file=sys.stderr)
        seen.append((times, peer))
    return [min(seen, key=lambda entry: entry[0][kind])[1] for kind in (0, 1)]


def race(engine_step, problem, folder, settings, rounds, count):
    """For wall and CPU time: the peer's setting, and pairs of its and the engine's milliseconds an update."""
    peers = best_peers(lambda setting: TorchTrainer(problem, setting), settings, max(2, count // 4))
    path = os.path.join(folder, f"problem{problem.sequences}")
    problem.save(path, {})
    engine = EngineTrainer(engine_step, path)
    engine(3)
    times = [[], []]
    for _ in range(rounds):
        for kind, peer in enumerate(peers):
            times[kind].append((peer(count)[kind], engine(count)[kind]))
    engine.close()
    return [(kind, peer.setting, pairs) for kind, peer, pairs in zip(("wall", "CPU"), peers, times)]
