#!/usr/bin/env python3
"""A model of `touchtrace train` as a PyTorch module. Needs torch alone; copy this file into your project.

    from touchtrace_model import TouchtraceModel
    model = TouchtraceModel.load("full.safetensors")    # float32, with gradients
    states, half_widths = model(state, touch)           # roll-out; state [N, 12] in m and m/s, touch [N, T, M, rows, cols]

State: position and velocity of the object, then of the hand, in the colour camera's frame. Touch: pressure from 0 to 1 of the
last M frames before each of T steps, averaged by area to the model's rows x cols (without touch only T matters). A model with an object encoder also needs
`segment` [N, frames, rows, cols], touch of the same object. Results [N, T, 12]: state after each step, and half the width of
the band between the model's quantiles, before the factors `band_scale` of the model card (`model.card`).
"""

import json

import torch
from torch import nn
from torch.nn import functional as F

ACTIVATIONS = {"relu": nn.ReLU, "silu": nn.SiLU, "tanh": nn.Tanh}


class Encoder(nn.Module):
    """Embedding of a window of frames; its channels are 5 times the differences of neighbours, and the last frame."""

    def __init__(self, spec, frames):
        super().__init__()
        kernel, channels = spec["tactile_kernel"], [frames, 32, 64, 128]
        for i, stride in enumerate(spec["tactile_strides"]):
            self.add_module(f"conv{i + 1}", nn.Conv2d(channels[i], channels[i + 1], kernel, stride, kernel // 2))
        self.dense = nn.LazyLinear(spec["embedding"])
        self.norm = nn.LayerNorm(spec["embedding"])

    def forward(self, frames):
        x = torch.cat([5 * frames.diff(dim=1), frames[:, -1:]], 1)
        for convolution in (self.conv1, self.conv2, self.conv3):
            x = F.relu(convolution(x))
        return self.norm(self.dense(x.flatten(1)))


class TouchtraceModel(nn.Module):
    def __init__(self, card):
        super().__init__()
        self.card, spec = card, card["spec"]
        self.has_touch, self.has_object = spec["touch"], "object" in spec
        self.register_buffer("mean", torch.tensor(card["scaling"]["mean"]), persistent=False)
        self.register_buffer("sigma", torch.tensor(card["scaling"]["deviation"]), persistent=False)
        if self.has_touch:
            self.tactile = Encoder(spec, spec["window_frames"])
        if self.has_object:
            self.object = Encoder(spec, spec["segment_frames"])
        inputs = spec["state"] + spec["embedding"] * (self.has_touch + self.has_object)
        hidden, activation = spec["hidden"], ACTIVATIONS[spec["activation"]]
        if spec["dynamics"] == "gru":
            self.dynamics = nn.ModuleDict({"cell": nn.GRUCell(inputs, hidden), "out": nn.Linear(hidden, 2 * spec["state"])})
        else:
            self.dynamics = nn.Sequential(nn.Linear(inputs, hidden), activation(), nn.Linear(hidden, hidden), activation(),
                                          nn.Linear(hidden, 2 * spec["state"]))

    @classmethod
    def load(cls, path):
        with open(path, "rb") as file:  # safetensors: header size, JSON header, values
            header = json.loads(file.read(int.from_bytes(file.read(8), "little")))
            data = bytearray(file.read())
        model = cls(json.loads(header.pop("__metadata__")["metadata"]))
        floats = torch.frombuffer(data, dtype=torch.float32)
        model.load_state_dict({name: floats[entry["data_offsets"][0] // 4:entry["data_offsets"][1] // 4].reshape(entry["shape"])
                               for name, entry in header.items()})
        return model

    def forward(self, state, touch, segment=None):
        state, hidden = (state - self.mean) / self.sigma, None
        known = [self.object(segment)] if self.has_object else []
        states, half_widths = [], []
        for window in touch.unbind(1):
            x = torch.cat([state, *([self.tactile(window)] if self.has_touch else []), *known], 1)
            if isinstance(self.dynamics, nn.ModuleDict):
                hidden = self.dynamics["cell"](x, hidden)
                x = self.dynamics["out"](hidden)
            else:
                x = self.dynamics(x)
            change, band = x.chunk(2, 1)
            state = state + change
            states.append(state * self.sigma + self.mean)
            half_widths.append(F.softplus(band) * self.sigma)
        return torch.stack(states, 1), torch.stack(half_widths, 1)
