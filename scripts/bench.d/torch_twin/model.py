"""The model, with the engine's names of parameters."""
import torch
from torch import nn
from torch.nn import functional as F

SPEC = dict(touch=True, window_frames=10, rows=32, cols=32, embedding=64, hidden=256, state=12)


class Model(nn.Module):
    def __init__(self, spec=SPEC):
        super().__init__()
        self.spec = spec
        size = [-(-n // 8) for n in (spec["rows"], spec["cols"])]
        self.tactile = nn.ModuleDict(dict(
            conv1=nn.Conv2d(spec["window_frames"], 32, 3, 2, 1),
            conv2=nn.Conv2d(32, 64, 3, 2, 1),
            conv3=nn.Conv2d(64, 128, 3, 2, 1),
            dense=nn.Linear(128 * size[0] * size[1], spec["embedding"]),
            norm=nn.LayerNorm(spec["embedding"])))
        self.dynamics = nn.Sequential(
            nn.Linear(spec["state"] + spec["embedding"], spec["hidden"]), nn.ReLU(),
            nn.Linear(spec["hidden"], spec["hidden"]), nn.ReLU(),
            nn.Linear(spec["hidden"], 2 * spec["state"]))

    def embed(self, windows):
        x = windows
        for conv in ("conv1", "conv2", "conv3"):
            x = F.relu(self.tactile[conv](x))
        return self.tactile["norm"](self.tactile["dense"](x.flatten(1)))

    def forward(self, windows, state, steps):
        """windows [T * S, M, rows, cols], state [S, state] -> states and spreads [T, S, state]

        The embeddings' part of the first layer is hoisted out of the loop."""
        n = self.spec["state"]
        first, rest = self.dynamics[0], self.dynamics[1:]
        hoisted = F.linear(self.embed(windows), first.weight[:, n:], first.bias).unflatten(0, (steps, -1))
        w_state, states, bands = first.weight[:, :n], [], []
        for t in range(steps):
            out = rest(F.linear(state, w_state) + hoisted[t])
            state = state + out[:, :n]
            states.append(state)
            bands.append(out[:, n:])
        return torch.stack(states), F.softplus(torch.stack(bands))


def pinball(p, tau):
    return torch.maximum(tau * p, (tau - 1) * p)


def loss_of(states, spread, target, weight):
    """Equation 4, all [T, S, state]; weight [T, S] sums to 1 / state."""
    loss = (target - states).abs()
    loss = loss + pinball(target - states + spread, 0.1) + pinball(target - states - spread, 0.9)
    return (loss * weight[:, :, None]).sum()


def with_differences(stream):
    """[frames, rows, cols] -> [2 frames, rows, cols]: differences to the frame before times 5, then the frames.
    Made once, so that a window in the difference basis is nothing but frames picked out."""
    return torch.cat([torch.zeros_like(stream[:1]), 5 * (stream[1:] - stream[:-1]), stream])


def windows_of(frames, last_frame, spec=SPEC):
    """frames as with_differences gives them, last_frame [W] -> [W, M, rows, cols]"""
    m = spec["window_frames"]
    places = last_frame[:, None] + torch.arange(2 - m, 2)
    places[:, -1] += len(frames) // 2 - 1
    return frames.index_select(0, places.flatten()).unflatten(0, (-1, m))
