"""Figure 6: one step at batch 1, a window in, state and band out, on an idle machine and with one busy core."""
import contextlib
import os
import statistics
import subprocess
import sys
import time

import numpy as np
import torch
from torch import nn

from .model import windows_of
from .training import HOPELESS

WARM_UP = 30  # steps


class Step(nn.Module):
    def __init__(self, model):
        super().__init__()
        self.model = model

    def forward(self, window, state):
        states, spreads, _ = self.model(window, None, state, 1)
        return states[0], spreads[0]


class TorchOnline:
    """The window lies ready as the model wants it: PyTorch pays for no gathering."""

    def __init__(self, problem, model, setting, frozen):
        self.setting, self.name = setting, f"frozen TorchScript, {setting}" if frozen else str(setting)
        self.step = Step(model).eval().to(memory_format=setting.format)
        batch = problem.batch(0)
        window = windows_of(problem.frames(), batch.last_frame[:1], problem.spec["window_frames"])
        self.window, self.state = window.contiguous(memory_format=setting.format), batch.initial_state
        with torch.no_grad():
            if frozen:
                self.step = torch.jit.freeze(torch.jit.trace(self.step, (self.window, self.state)))
            self.step = setting.applied_to(self.step, freezing=True)

    def __call__(self, count):
        """Microseconds of each step."""
        torch.set_num_threads(self.setting.threads)
        times = np.empty(count)
        with torch.inference_mode() if not self.setting.compiled else torch.no_grad():
            for i in range(count):
                start = time.perf_counter()
                self.result = self.step(self.window, self.state)
                times[i] = time.perf_counter() - start
        return 1e6 * times


class EngineOnline:
    def __init__(self, engine_step, path):
        self.process = subprocess.Popen([engine_step, path, "online"], text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __call__(self, count):
        print(count, file=self.process.stdin, flush=True)
        times, self.result = (np.array(self.process.stdout.readline().split(), float) for _ in range(2))
        return times

    def close(self):
        self.process.stdin.close()
        self.process.wait()


@contextlib.contextmanager
def busy_core():
    """Another process that computes without a break, on the last core."""
    busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    os.sched_setaffinity(busy.pid, {max(os.sched_getaffinity(0))})
    try:
        yield
    finally:
        busy.kill()
        busy.wait()


def best_online(problem, model, settings, count):
    """The peer with the smallest median."""
    best, best_us = None, float("inf")
    for setting in settings:
        for frozen in (False, True) if not setting.compiled else (False,):
            try:
                peer = TorchOnline(problem, model, setting, frozen)
                peer(WARM_UP)
                middle = statistics.median(peer(WARM_UP))
            except Exception as error:  # PyTorch cannot run this variant here
                print(f"PyTorch online, {setting}: {type(error).__name__}: {error}", file=sys.stderr)
                continue
            if middle < HOPELESS * best_us:
                middle = statistics.median(peer(count))
            print(f"PyTorch online, {peer.name}: {middle:.1f} us", file=sys.stderr)
            if middle < best_us:
                best, best_us = peer, middle
    return best


def distance(engine, peer):
    """Relative, of state and spread after the same step."""
    expected = np.concatenate([part.flatten().numpy() for part in peer.result])
    return np.linalg.norm(engine.result - expected) / np.linalg.norm(expected)
