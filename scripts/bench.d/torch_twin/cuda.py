"""A training step of PyTorch on a GPU, eager or compiled, launched one kernel at a time or as one CUDA graph."""
import collections

import torch

from .training import WARM_UP, Setting, TorchTrainer


class CudaSetting(collections.namedtuple("CudaSetting", "graph compiled channels_last")):
    threads = 1

    def __str__(self):
        return ", ".join(("compiled" if self.compiled else "eager",
                          "channels_last" if self.channels_last else "NCHW",
                          "CUDA graph" if self.graph else "CUDA launches"))

    format = Setting.format

    def applied_to(self, function):
        return torch.compile(function, dynamic=False) if self.compiled else function


class CudaTrainer(TorchTrainer):
    """Batches come from the host at every update, as the engine's do."""
    device = "cuda"

    def __init__(self, problem, setting):
        self.stream, self.captured = torch.cuda.Stream(), None
        with torch.cuda.stream(self.stream):
            super().__init__(problem, setting)
            self.batches = [[None if part is None else part.pin_memory() for part in batch] for batch in self.batches]
            batch = problem.batch(0)
            self.batch = type(batch)(*(None if part is None else part.to(self.device) for part in batch))

    def start(self, weights=None):
        super().start(weights)
        for group in self.optimizer.param_groups:  # a graph reads the rate again only from memory of its own
            group.update(lr=torch.tensor(group["lr"], device=self.device), capturable=True)

    def set_rate(self, rate):
        for group in self.optimizer.param_groups:
            group["lr"].fill_(rate)

    def step(self, batch):
        for place, part in zip(self.batch, batch):
            if part is not None:
                place.copy_(part, non_blocking=True)
        if not self.setting.graph or self.updates < WARM_UP:
            return super().step(self.batch)
        if not self.captured:
            self.captured = torch.cuda.CUDAGraph()
            with torch.cuda.graph(self.captured, stream=self.stream):
                self.graph_loss = super().step(self.batch)
        self.captured.replay()
        return self.graph_loss

    def update(self):
        with torch.cuda.stream(self.stream):
            return super().update()
