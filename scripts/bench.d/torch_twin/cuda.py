"""A training step of PyTorch on a GPU, eager or as one CUDA graph."""
import torch

from .training import WARM_UP, Setting, TorchTrainer


class CudaTrainer(TorchTrainer):
    """Batches come from the host at every update, as the engine's do."""
    device = "cuda"

    def __init__(self, problem, channels_last, graph):
        self.stream, self.graph, self.captured = torch.cuda.Stream(), graph, None
        with torch.cuda.stream(self.stream):
            super().__init__(problem, Setting(False, channels_last, 1))
            self.batches = [[None if part is None else part.pin_memory() for part in batch] for batch in self.batches]
            batch = problem.batch(0)
            self.batch = type(batch)(*(None if part is None else part.to(self.device) for part in batch))
        self.name = f"CUDA {'graph' if graph else 'eager'}, {'channels_last' if channels_last else 'NCHW'}"

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
        if not self.graph or self.updates < WARM_UP:
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
