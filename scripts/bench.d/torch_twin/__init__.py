"""The model of engine/model in PyTorch, as one would write it there to be fast, and what it shares with the engine."""
