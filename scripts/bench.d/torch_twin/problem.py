"""What both sides compute: a stream of frames and batches of roll-outs in it, as a file for engine_step."""
import json

import numpy as np
import torch
from safetensors.numpy import save_file

from .model import SPEC, with_differences

STEPS, FRAMES = 20, 400


class Problem:
    """Arrays as engine_step reads them (tests/engine/step/main.cpp): `batches` batches of `sequences` roll-outs."""

    def __init__(self, arrays, sequences, steps=STEPS, options=None):
        self.arrays, self.sequences, self.steps = arrays, sequences, steps
        self.options = options or {}
        self.batches = len(arrays["first_frame"]) // sequences

    def save(self, path, weights):
        """With a model's weights the file is a model file, too."""
        save_file({**self.arrays, **weights}, path, metadata=dict(
            spec=json.dumps(SPEC), metadata="{}", sequences=str(self.sequences), steps=str(self.steps),
            options=json.dumps(self.options)))

    def frames(self, dtype=torch.float32):
        return with_differences(torch.tensor(self.arrays["stream"], dtype=dtype))

    def batch(self, index, dtype=torch.float32):
        """last_frame [T * S], initial state [S, state], target [T, S, state], weight [T, S]; rows by step."""
        s, t, n = self.sequences, self.steps, SPEC["state"]

        def part(name, *shape):
            return self.arrays[name].reshape(self.batches, s, *shape)[index % self.batches]

        last = part("first_frame").astype(np.int64) + np.arange(t)[:, None]
        weight = part("weight", t).astype(np.float64)
        weight = weight.T / (weight.sum() * n)
        return (torch.tensor(last.reshape(-1)), torch.tensor(part("initial_state", n), dtype=dtype),
                torch.tensor(part("target", t, n), dtype=dtype).transpose(0, 1).contiguous(),
                torch.tensor(weight, dtype=dtype).contiguous())


def noise_problem(sequences, seed):
    random = np.random.default_rng(seed)
    first = random.integers(SPEC["window_frames"] - 1, FRAMES - STEPS, sequences)
    return Problem(dict(
        first_frame=first.astype(np.float32),
        stream=random.random((FRAMES, SPEC["rows"], SPEC["cols"]), np.float32),
        initial_state=random.standard_normal((sequences, SPEC["state"]), np.float32),
        target=random.standard_normal((sequences, STEPS, SPEC["state"]), np.float32),
        weight=random.random((sequences, STEPS), np.float32)), sequences)


def weights_of(model):
    return {name: value.detach().float().contiguous().numpy() for name, value in model.state_dict().items()}
