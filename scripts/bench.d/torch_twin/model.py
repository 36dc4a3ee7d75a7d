"""The model, with the engine's names of parameters."""
import torch
from torch import nn
from torch.nn import functional as F

from .dynamics import KINDS

ONE_ENCODER = dict(touch=True, window_frames=10, rows=32, cols=32, embedding=64, hidden=256, state=12, band_quantile=0.1)
OTHER_CONVOLUTIONS = dict(ONE_ENCODER, rows=12, cols=12, tactile_kernel=5, tactile_strides=[1, 2, 1])
BOTH_ENCODERS = dict(**ONE_ENCODER, object="joint", segment_frames=20, contrast_temperature=0.0)


class Encoder(nn.Module):
    def __init__(self, spec, frames):
        super().__init__()
        kernel, size = spec.get("tactile_kernel", 3), [spec["rows"], spec["cols"]]
        channels = [frames, 32, 64, 128]
        for i, stride in enumerate(spec.get("tactile_strides", [2, 2, 2])):
            setattr(self, f"conv{i + 1}", nn.Conv2d(channels[i], channels[i + 1], kernel, stride, kernel // 2))
            size = [-(-n // stride) for n in size]
        self.dense = nn.Linear(channels[-1] * size[0] * size[1], spec["embedding"])
        self.norm = nn.LayerNorm(spec["embedding"])

    def forward(self, x):
        for conv in (self.conv1, self.conv2, self.conv3):
            x = F.relu(conv(x))
        return self.norm(self.dense(x.flatten(1)))


class Model(nn.Module):
    def __init__(self, spec):
        super().__init__()
        self.spec, embeddings = spec, 1
        self.tactile = Encoder(spec, spec["window_frames"])
        if "object" in spec:
            self.object, embeddings = Encoder(spec, spec["segment_frames"]), 2
        self.dynamics = KINDS[spec.get("dynamics", "mlp")](spec, embeddings)

    def forward(self, windows, segments, state, steps):
        """windows [T * S, M, rows, cols], segments [S, frames, rows, cols] or None, state [S, state]
        -> states and spreads [T, S, state], embeddings of the objects [S, embedding] or None"""
        n = self.spec["state"]
        objects = None if segments is None else self.object(segments)
        states, bands, memory = [], [], None
        for inputs in self.dynamics.inputs(self.tactile(windows).unflatten(0, (steps, -1)), objects):
            out, memory = self.dynamics(state, inputs, memory)
            state = state + out[:, :n]
            states.append(state)
            bands.append(out[:, n:])
        return torch.stack(states), F.softplus(torch.stack(bands)), objects


def pinball(p, tau):
    return torch.maximum(tau * p, (tau - 1) * p)


def state_loss(states, spread, batch, quantile):
    """Equation 4, all [T, S, state]; weight [T, S] sums to 1 / state; the band lies between `quantile` and 1 - `quantile`."""
    error = batch.target - states
    loss = error.abs() + pinball(error + spread, quantile) + pinball(error - spread, 1 - quantile)
    return (loss * batch.weight[:, :, None]).sum()


def contrastive_loss(objects, batch):
    """Equation 5 with its sign turned, over all pairs of segments with the same object."""
    logits = objects @ objects.T
    negatives = logits.masked_fill(~batch.negative, -torch.inf).logsumexp(1)
    return (F.softplus(negatives[:, None] - logits) * batch.positive_weight).sum()


def loss_of(predicted, batch, quantile):
    states, spread, objects = predicted
    loss = state_loss(states, spread, batch, quantile)
    return loss if objects is None else loss + contrastive_loss(objects, batch)


def with_differences(stream):
    """[frames, rows, cols] -> [2 frames, rows, cols]: differences to the frame before times 5, then the frames.
    Computed once: a window in the difference basis is then a selection of these frames."""
    return torch.cat([torch.zeros_like(stream[:1]), 5 * (stream[1:] - stream[:-1]), stream])


def windows_of(frames, last_frame, length):
    """frames as with_differences gives them, last_frame [W] -> [W, length, rows, cols]"""
    places = last_frame[:, None] + torch.arange(2 - length, 2, device=frames.device)
    places[:, -1] += len(frames) // 2 - 1
    return frames.index_select(0, places.flatten()).unflatten(0, (-1, length))
