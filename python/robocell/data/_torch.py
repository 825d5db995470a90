"""Steps as tensors. Use ``robocell.data.torch_dataset``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.utils.data import Dataset

from robocell._core import ArgumentError
from robocell.data._steps import EPISODE, PAD, ROW, Item, Key, Steps

MILLIMETRES = np.float32(1000)  # of a metre


class TorchSteps(Dataset[Any]):
    """The items of ``Steps`` as tensors, see ``torch_dataset``.

    Attributes:
        steps: The same items as numpy arrays; ``steps.starts`` has where episodes begin.
    """

    def __init__(
        self, steps: Steps, dtype: str = "float32", transform: Callable[[Item], Any] | None = None
    ) -> None:
        if dtype not in ("float16", "float32", "float64"):
            raise ArgumentError(f"dtype is '{dtype}'; it is 'float16', 'float32' or 'float64'")
        self.steps = steps
        self._dtype = np.dtype(dtype)
        self._transform = transform

    def __len__(self) -> int:
        return len(self.steps)

    def __getitem__(self, index: int) -> Any:
        return self._tensors(self.steps[index])

    def __getitems__(self, indices: Sequence[int]) -> list[Any]:
        """Returns the items of a batch; a ``DataLoader`` calls this."""
        return [self._tensors(item) for item in self.steps.__getitems__(indices)]

    def _tensors(self, item: Item) -> Any:
        tensors: Item = {}
        for key in self.steps.keys:
            tensors[key.name] = torch.from_numpy(self._converted(key, np.asarray(item[key.name])))
            if not key.is_single:
                tensors[key.name + PAD] = torch.from_numpy(item[key.name + PAD])
        for name in (EPISODE, ROW):
            tensors[name] = torch.tensor(item[name])
        return tensors if self._transform is None else self._transform(tensors)

    def _converted(self, key: Key, values: NDArray[Any]) -> NDArray[Any]:
        if key.kind == "rgb":
            return np.ascontiguousarray(np.moveaxis(values, -1, -3))
        if key.kind == "depth":
            return np.expand_dims(values / MILLIMETRES, -3)
        if key.kind == "segmentation":
            return np.expand_dims(values.astype(np.int32), -3)
        if values.dtype.kind == "f":
            return values.astype(self._dtype)
        return values.copy()  # tensors are written to; what numpy has may be of a larger array
