"""What both sides compute: a stream of frames and batches of roll-outs in it, as a file for engine_step."""
import json
import typing

import numpy as np
import torch
from safetensors.numpy import save_file

from .model import with_differences

STEPS, FRAMES = 20, 400
# What Trainer takes where a problem's options say nothing (engine/train/trainer.h).
DEFAULTS = dict(updates=3000, learning_rate=2e-3, weight_decay=0.1, object_loss=0.1)


class Batch(typing.NamedTuple):
    """Rows by step. Pairs of segments: which are negatives, and what positive ones weigh."""
    last_frame: torch.Tensor                 # [T * S]
    initial_state: torch.Tensor              # [S, state]
    target: torch.Tensor                     # [T, S, state]
    weight: torch.Tensor                     # [T, S], sums to 1 / state
    segment_last_frame: torch.Tensor | None  # [S]
    negative: torch.Tensor | None            # [S, S]
    positive_weight: torch.Tensor | None     # [S, S]


def pairs(objects, object_loss):
    """negative and positive_weight: the mean over anchors with both kinds of pairs, then over their positives."""
    same = objects[:, None] == objects
    positive = same & ~np.eye(len(objects), dtype=bool)
    positives, negatives = positive.sum(1), (~same).sum(1)
    counts = (positives > 0) & (negatives > 0)
    return ~same, positive * (counts * object_loss / np.maximum(counts.sum() * positives, 1))[:, None]


class Problem:
    """Arrays as engine_step reads them (tests/engine/step/problem.h): batches of `sequences` roll-outs."""

    def __init__(self, spec, arrays, sequences, steps=STEPS, options=None):
        self.spec, self.arrays, self.sequences, self.steps = spec, arrays, sequences, steps
        self.given_options = options or {}
        self.options = {**DEFAULTS, **self.given_options}
        self.batches = len(arrays["first_frame"]) // sequences

    def save(self, path, weights):
        """With a model's weights the file is a model file, too."""
        save_file({**self.arrays, **weights}, path, metadata=dict(
            spec=json.dumps(self.spec), metadata="{}", sequences=str(self.sequences), steps=str(self.steps),
            options=json.dumps(self.given_options)))

    def frames(self, dtype=torch.float32):
        return with_differences(torch.tensor(self.arrays["stream"], dtype=dtype))

    def batch(self, index, dtype=torch.float32):
        s, t, n = self.sequences, self.steps, self.spec["state"]

        def part(name, *shape):
            return self.arrays[name].reshape(self.batches, s, *shape)[index]

        last = part("first_frame").astype(np.int64) + np.arange(t)[:, None]
        weight = part("weight", t).astype(np.float64)
        weight = weight.T / (weight.sum() * n)
        segments = negative = positive_weight = None
        if "object" in self.spec:
            segments = torch.tensor(part("segment_frame").astype(np.int64) + self.spec["segment_frames"] - 1)
            negative, positive_weight = map(torch.tensor, pairs(part("object"), self.options["object_loss"]))
            positive_weight = positive_weight.to(dtype)
        return Batch(torch.tensor(last.reshape(-1)), torch.tensor(part("initial_state", n), dtype=dtype),
                     torch.tensor(part("target", t, n), dtype=dtype).transpose(0, 1).contiguous(),
                     torch.tensor(weight, dtype=dtype).contiguous(), segments, negative, positive_weight)


def noise_problem(spec, sequences, seed):
    random = np.random.default_rng(seed)
    first = random.integers(spec["window_frames"] - 1, FRAMES - STEPS, sequences)
    arrays = dict(
        first_frame=first.astype(np.float32),
        stream=random.random((FRAMES, spec["rows"], spec["cols"]), np.float32),
        initial_state=random.standard_normal((sequences, spec["state"]), np.float32),
        target=random.standard_normal((sequences, STEPS, spec["state"]), np.float32),
        weight=random.random((sequences, STEPS), np.float32))
    if "object" in spec:
        arrays["object"] = (np.arange(sequences) // 2 % 4).astype(np.float32)
        last_start = FRAMES - spec["segment_frames"]
        arrays["segment_frame"] = random.integers(0, last_start, sequences).astype(np.float32)
    return Problem(spec, arrays, sequences)


def weights_of(model):
    return {name: value.detach().float().contiguous().numpy() for name, value in model.state_dict().items()}
