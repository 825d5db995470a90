"""Statistics of features, in one pass and with constant memory.

Vectors: minimum, maximum, mean and standard deviation are exact; quantiles are exact up to
`Vectors.KEPT` rows, and beyond that those of every 2nd, 4th, 8th ... row. Images: everything is
derived from a histogram of the 256 values of each channel.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}

Statistics = dict[str, Any]


class Vectors:
    """Statistics of rows of `size` numbers; quantiles are exact up to `kept` rows (`KEPT`)."""

    KEPT = 1 << 16

    def __init__(self, size: int, kept: int | None = None) -> None:
        self.count = 0
        self._most = kept or self.KEPT
        self._low = np.full(size, np.inf)
        self._high = np.full(size, -np.inf)
        self._mean = np.zeros(size)
        self._squares = np.zeros(size)  # sum of squared distances from the mean
        self._kept = np.empty((0, size))
        self._stride = 1

    def add(self, rows: NDArray[Any]) -> None:
        """Adds (rows, size) numbers."""
        values = np.asarray(rows, np.float64)
        if not len(values):
            return
        mean = values.mean(axis=0)
        squares = ((values - mean) ** 2).sum(axis=0)
        whole = self.count + len(values)
        apart = mean - self._mean
        self._squares += squares + apart**2 * (self.count * len(values) / whole)
        self._mean += apart * (len(values) / whole)
        self._low = np.minimum(self._low, values.min(axis=0))
        self._high = np.maximum(self._high, values.max(axis=0))
        first = -self.count % self._stride
        self._kept = np.concatenate([self._kept, values[first :: self._stride]])
        self.count = whole
        while len(self._kept) > self._most:
            self._kept = self._kept[::2]
            self._stride *= 2

    def result(self) -> Statistics:
        """Returns the statistics as lists; there must be a row."""
        quantiles = np.quantile(self._kept, list(QUANTILES.values()), axis=0)
        return {
            "min": self._low.tolist(),
            "max": self._high.tolist(),
            "mean": self._mean.tolist(),
            "std": np.sqrt(self._squares / self.count).tolist(),
            "count": [self.count],
            **{name: row.tolist() for name, row in zip(QUANTILES, quantiles, strict=True)},
        }


class Images:
    """Statistics of the three channels of images, as numbers from 0 to 1."""

    def __init__(self) -> None:
        self.images = 0
        self.histogram = np.zeros((3, 256), np.int64)

    def add(self, image: NDArray[np.uint8]) -> None:
        """Adds an image (height, width, 3)."""
        self.images += 1
        for channel in range(3):
            self.histogram[channel] += np.bincount(image[..., channel].ravel(), minlength=256)

    def merge(self, images: int, histogram: NDArray[Any]) -> None:
        """Adds what other statistics have counted."""
        self.images += images
        self.histogram += np.asarray(histogram, np.int64)

    def result(self) -> Statistics:
        """Returns the statistics as lists of the shape (3, 1, 1); there must be an image."""
        levels = np.arange(256) / 255
        pixels = self.histogram.sum(axis=1)
        mean = self.histogram @ levels / pixels
        square = self.histogram @ levels**2 / pixels
        used = self.histogram > 0
        reached = self.histogram.cumsum(axis=1)
        found = {
            "min": levels[used.argmax(axis=1)],
            "max": levels[255 - used[:, ::-1].argmax(axis=1)],
            "mean": mean,
            "std": np.sqrt(np.maximum(square - mean**2, 0)),
        }
        for name, share in QUANTILES.items():
            found[name] = levels[(reached >= share * pixels[:, None]).argmax(axis=1)]
        shaped = {name: each.reshape(3, 1, 1).tolist() for name, each in found.items()}
        return {**shaped, "count": [self.images]}
