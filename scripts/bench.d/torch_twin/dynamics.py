"""The dynamics, with the engine's names of parameters. `inputs` converts the embeddings to the constant input of all steps;
`forward` returns [delta, band] and the memory of the next step."""
import torch
from torch import nn
from torch.nn import functional as F

ACTIVATIONS = dict(relu=nn.ReLU, silu=nn.SiLU, tanh=nn.Tanh)


class Mlp(nn.Sequential):
    def __init__(self, spec, embeddings):
        activation = ACTIVATIONS[spec.get("activation", "relu")]
        super().__init__(
            nn.Linear(spec["state"] + embeddings * spec["embedding"], spec["hidden"]), activation(),
            nn.Linear(spec["hidden"], spec["hidden"]), activation(),
            nn.Linear(spec["hidden"], 2 * spec["state"]))
        self.state, self.with_touch = spec["state"], spec["state"] + spec["embedding"]

    def inputs(self, touch, objects):
        """touch [T, S, embedding], objects [S, embedding] or None -> [T, S, hidden]: what they give to the first
        layer, which needs no loop."""
        first = self[0]
        sums = F.linear(touch, first.weight[:, self.state:self.with_touch], first.bias)
        return sums if objects is None else sums + F.linear(objects, first.weight[:, self.with_touch:])

    def forward(self, state, sums, memory):
        x = F.linear(state, self[0].weight[:, :self.state]) + sums
        for layer in list(self)[1:]:
            x = layer(x)
        return x, memory


class Gru(nn.Module):
    """PyTorch's own cell as it stands, nothing hoisted."""

    def __init__(self, spec, embeddings):
        super().__init__()
        self.cell = nn.GRUCell(spec["state"] + embeddings * spec["embedding"], spec["hidden"])
        self.out = nn.Linear(spec["hidden"], 2 * spec["state"])

    def inputs(self, touch, objects):
        return touch if objects is None else torch.cat([touch, objects.expand(len(touch), -1, -1)], 2)

    def forward(self, state, embeddings, memory):
        memory = self.cell(torch.cat([state, embeddings], 1), memory)
        return self.out(memory), memory


KINDS = dict(mlp=Mlp, gru=Gru)
