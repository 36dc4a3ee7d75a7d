# The engine against PyTorch: the same loss and gradients in double, and a training step timed in turns.
# needs: torch numpy safetensors
import argparse
import itertools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import torch
from safetensors.numpy import load_file, save_file
from torch import nn
from torch.nn import functional as F

SPEC = dict(touch=True, window_frames=10, rows=32, cols=32, embedding=64, hidden=256, state=12)
STEPS, FRAMES, DROPOUT = 20, 400, 0.2


class Model(nn.Module):
    """The model of engine/model, with its names of parameters, as one would write it in PyTorch."""

    def __init__(self, spec):
        super().__init__()
        self.spec = spec
        inputs = spec["state"]
        if spec["touch"]:
            inputs += spec["embedding"]
            size = [-(-n // 8) for n in (spec["rows"], spec["cols"])]
            self.tactile = nn.ModuleDict(dict(
                conv1=nn.Conv2d(spec["window_frames"], 32, 3, 2, 1),
                conv2=nn.Conv2d(32, 64, 3, 2, 1),
                conv3=nn.Conv2d(64, 128, 3, 2, 1),
                dense=nn.Linear(128 * size[0] * size[1], spec["embedding"]),
                norm=nn.LayerNorm(spec["embedding"])))
        self.dynamics = nn.Sequential(
            nn.Linear(inputs, spec["hidden"]), nn.ReLU(),
            nn.Linear(spec["hidden"], spec["hidden"]), nn.ReLU(),
            nn.Linear(spec["hidden"], 2 * spec["state"]))

    def embed(self, windows):
        x = windows
        for conv in ("conv1", "conv2", "conv3"):
            x = F.relu(self.tactile[conv](x))
        return self.tactile["norm"](self.tactile["dense"](x.flatten(1)))

    def forward(self, windows, state, steps):
        """windows [T * S, M, rows, cols], state [S, state] -> states and spreads [T, S, state]"""
        n = self.spec["state"]
        first, rest = self.dynamics[0], self.dynamics[1:]
        hoisted = first.bias.expand(steps, len(state), -1)
        if self.spec["touch"]:
            hoisted = F.linear(self.embed(windows), first.weight[:, n:], first.bias)
            hoisted = hoisted.view(steps, len(state), -1)
        w_state, states, bands = first.weight[:, :n], [], []
        for t in range(steps):
            out = rest(F.linear(state, w_state) + hoisted[t])
            state = state + out[:, :n]
            states.append(state)
            bands.append(out[:, n:])
        return torch.stack(states), F.softplus(torch.stack(bands))


def pinball(p, tau):
    return torch.maximum(tau * p, (tau - 1) * p)


def loss_of(states, spread, target):
    loss = (target - states).abs()
    return (loss + pinball(target - states + spread, 0.1) + pinball(target - states - spread, 0.9)).mean()


def windows_of(stream, last_frame, spec):
    """Windows in the difference basis, [W, M, rows, cols]."""
    m = spec["window_frames"]
    raw = stream[last_frame[:, None] + torch.arange(1 - m, 1)]
    return torch.cat([5 * raw[:, 1:].sub(raw[:, :-1]), raw[:, -1:]], 1)


def make_problem(sequences, seed):
    random = np.random.default_rng(seed)
    n = SPEC["state"]
    first = random.integers(SPEC["window_frames"] - 1, FRAMES - STEPS, sequences)
    return dict(
        first_frame=first.astype(np.float32),
        stream=random.random((FRAMES, SPEC["rows"], SPEC["cols"]), np.float32),
        initial_state=random.standard_normal((sequences, n), np.float32),
        target=random.standard_normal((sequences, STEPS, n), np.float32))


def batch_of(problem, dtype):
    """stream, last_frame [T * S], initial state, target [T, S, state] as tensors."""
    last = problem["first_frame"].astype(np.int64)[None, :] + np.arange(STEPS)[:, None]
    return (torch.tensor(problem["stream"], dtype=dtype), torch.tensor(last.reshape(-1)),
            torch.tensor(problem["initial_state"], dtype=dtype),
            torch.tensor(problem["target"], dtype=dtype).transpose(0, 1).contiguous())


def save_problem(path, problem, model, sequences):
    weights = {k: v.detach().float().contiguous().numpy() for k, v in model.state_dict().items()}
    save_file({**problem, **weights}, path, metadata=dict(
        spec=json.dumps(SPEC), sequences=str(sequences), steps=str(STEPS)))


# How near to a kink of ReLU, L1 or pinball float may take the other side, which changes the gradient by far
# more than rounding does: sums of the MLP and the loss after 20 steps, and sums of the convolutions.
MLP_MARGIN, CONVOLUTION_MARGIN = 5e-6, 5e-7


def in_double(problem, model):
    """The loss, and the distance of the nearest kink in units of its margin."""
    distances, hooks = [], []

    def watch(module, margin):
        hooks.append(module.register_forward_hook(
            lambda _, inputs, out: distances.append((out.abs().min() / margin).item())))

    for i in (1, 2, 3):
        watch(model.tactile[f"conv{i}"], CONVOLUTION_MARGIN)
    watch(model.dynamics[2], MLP_MARGIN)
    hooks.append(model.dynamics[1].register_forward_pre_hook(
        lambda _, inputs: distances.append((inputs[0].abs().min() / MLP_MARGIN).item())))
    stream, last, initial, target = batch_of(problem, torch.float64)
    states, spread = model(windows_of(stream, last, SPEC), initial, STEPS)
    for hook in hooks:
        hook.remove()
    for side in (-1, 0, 1):
        distances.append(((target - states + side * spread).abs().min() / MLP_MARGIN).item())
    return loss_of(states, spread, target), min(distances)


def compare(engine_step, folder, seed):
    """Relative error of loss and of the whole gradient against double, for one roll-out away from kinks."""
    distance = 0.0
    while not distance > 1.0:
        torch.manual_seed(seed)
        problem, model = make_problem(1, seed), Model(SPEC)
        path, out = os.path.join(folder, "problem"), os.path.join(folder, "gradient")
        save_problem(path, problem, model, 1)
        loss, distance = in_double(problem, model.double())
        seed += 1
    loss.backward()
    subprocess.run([engine_step, path, "gradient", out], check=True)
    engine = load_file(out)
    off = total = 0.0
    for name, parameter in model.named_parameters():
        grad = parameter.grad.numpy()
        off += ((engine[name] - grad) ** 2).sum()
        total += (grad ** 2).sum()
    return abs(engine["loss"].item() - loss.item()) / loss.item(), (off / total) ** 0.5


class TorchStep:
    """A training step in PyTorch, data from host memory included."""

    def __init__(self, problem, compiled, channels_last, threads):
        self.name = ", ".join(("compiled" if compiled else "eager",
                               "channels_last" if channels_last else "NCHW", f"{threads} threads"))
        self.threads = threads
        self.batch = batch_of(problem, torch.float32)
        self.format = torch.channels_last if channels_last else torch.contiguous_format
        self.model = Model(SPEC).to(memory_format=self.format)
        decayed = [p for p in self.model.parameters() if p.dim() > 1]
        other = [p for p in self.model.parameters() if p.dim() <= 1]
        self.optimizer = torch.optim.AdamW([dict(params=decayed, weight_decay=0.1),
                                            dict(params=other, weight_decay=0.0)], lr=2e-3, fused=True)
        self.loss = torch.compile(self.loss_of_batch) if compiled else self.loss_of_batch

    def loss_of_batch(self, stream, last, initial, target):
        windows = windows_of(stream, last, SPEC)
        keep = (torch.rand(len(last), 1, SPEC["rows"], SPEC["cols"]) >= DROPOUT) / (1 - DROPOUT)
        windows = (windows * keep).contiguous(memory_format=self.format)
        return loss_of(*self.model(windows, initial, STEPS), target)

    def __call__(self, count):
        torch.set_num_threads(self.threads)
        wall, cpu = time.perf_counter(), time.process_time()
        for _ in range(count):
            self.optimizer.zero_grad()
            loss = self.loss(*self.batch)
            loss.backward()
            nn.utils.clip_grad_norm_(self.model.parameters(), 1.0, foreach=True)
            self.optimizer.step()
            loss.item()
        return [1e3 * (now - then) / count for now, then in
                ((time.perf_counter(), wall), (time.process_time(), cpu))]


class EngineStep:
    def __init__(self, engine_step, problem, folder, sequences):
        path = os.path.join(folder, f"problem{sequences}")
        save_problem(path, problem, nn.Module(), sequences)
        self.process = subprocess.Popen([engine_step, path, "time"], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def __call__(self, count):
        print(count, file=self.process.stdin, flush=True)
        return [float(word) for word in self.process.stdout.readline().split()]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def best_peers(problem, with_compiled):
    """The fastest of PyTorch's settings by wall time, and by CPU time."""
    seen = []
    settings = itertools.product([False, True] if with_compiled else [False], (False, True),
                                 sorted({1, os.cpu_count()}))
    for compiled, channels_last, threads in settings:
        step = TorchStep(problem, compiled, channels_last, threads)
        try:
            step(3)
        except Exception as error:  # a setting that PyTorch cannot compile here is no peer
            print(f"PyTorch {step.name}: {type(error).__name__}", file=sys.stderr)
            continue
        times = [min(run) for run in zip(*(step(3) for _ in range(3)))]
        print(f"PyTorch {step.name}: {times[0]:.1f} ms, {times[1]:.1f} CPU-ms a step", file=sys.stderr)
        seen.append((times, step))
    return [min(seen, key=lambda entry: entry[0][kind])[1] for kind in (0, 1)]


def race(engine_step, folder, sequences, rounds, count, with_compiled):
    """For wall and CPU time: the peer, and pairs of its and the engine's milliseconds a step."""
    problem = make_problem(sequences, sequences)
    peers = best_peers(problem, with_compiled)
    engine = EngineStep(engine_step, problem, folder, sequences)
    engine(3)
    times = [[], []]
    for _ in range(rounds):
        for kind, peer in enumerate(peers):
            times[kind].append((peer(count)[kind], engine(count)[kind]))
    engine.close()
    return zip(("wall", "CPU"), peers, times)


def row(name, value, unit, goal="reported", holds=True, seconds=0.0):
    return dict(name=name, value=value, unit=unit, goal=goal, holds=bool(holds), seconds=seconds)


def ratio_rows(sequences, goal, kind, peer, times, seconds):
    ratios = [torch_ms / engine_ms for torch_ms, engine_ms in times]
    middle, what = statistics.median(ratios), f"training step, {sequences} sequences, {kind} time: "
    yield row(f"{what}PyTorch {torch.__version__} ({peer.name}) / engine, "
              f"{min(ratios):.2f} .. {max(ratios):.2f}", middle, "x", f">= {goal}", middle >= goal, seconds)
    yield row(what + "engine", statistics.median(engine_ms for _, engine_ms in times), "ms")


def figures(options):
    torch.set_flush_denormal(True)
    with tempfile.TemporaryDirectory() as folder:
        start = time.time()
        loss, gradient = compare(options.engine_step, folder, options.seed)
        yield row("whole model, loss against PyTorch in double", loss, "relative", "<= 1e-05", loss <= 1e-5,
                  time.time() - start)
        yield row("whole model, gradient against PyTorch in double", gradient, "relative", "<= 1e-05",
                  gradient <= 1e-5)
        for sequences, goal in ((8, 2.0), (32, 1.7)):
            start = time.time()
            count = options.count * 8 // sequences
            kinds = race(options.engine_step, folder, sequences, options.rounds, count, not options.eager)
            for kind, peer, times in kinds:
                yield from ratio_rows(sequences, goal, kind, peer, times, time.time() - start)


def main():
    parser = argparse.ArgumentParser(description="the engine against PyTorch")
    parser.add_argument("--engine-step", default="build/release/tests/engine_step")
    parser.add_argument("--rounds", type=int, default=7, help="alternating runs of the timing")
    parser.add_argument("--count", type=int, default=20, help="steps a run at 8 sequences")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="of the gradient comparison")
    parser.add_argument("--eager", action="store_true", help="do not try torch.compile")
    parser.add_argument("--json", action="store_true", help="print all rows as one JSON object")
    options = parser.parse_args()
    print(f"seed {options.seed}", file=sys.stderr)
    rows = []
    for r in figures(options):
        rows.append(r)
        if not options.json:
            print(f"{r['name']:<124} {r['value']:>12.6g} {r['unit']:<9} {r['goal']:<10} "
                  f"{'holds' if r['holds'] else 'FALLS SHORT'}", flush=True)
    if options.json:
        print(json.dumps(dict(figures=rows)))


if __name__ == "__main__":
    main()
