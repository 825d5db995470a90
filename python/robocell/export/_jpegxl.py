"""Images in zarr arrays as JPEG XL, under the name that UMI's code registers its codec with.

The settings that are stored are those that every reader of this name accepts: UMI's own copy of the
codec, and the packages imagecodecs and imagecodecs-numcodecs.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from robocell._extras import needed_by

with needed_by("robocell.export", "umi"):
    import imagecodecs
    from numcodecs.abc import Codec
    from numcodecs.registry import register_codec

EFFORT = 3  # of 1 to 9; larger numbers take many times as long


class JpegXl(Codec):
    """A chunk is one image, compressed without loss.

    Args:
        settings: What another writer stored; decoding needs none of it.
    """

    codec_id: ClassVar[str] = "imagecodecs_jpegxl"

    def __init__(self, **settings: Any) -> None:
        self._settings = settings or {"effort": EFFORT, "lossless": True, "numthreads": 1}

    def encode(self, buf: Any) -> bytes:
        """Returns the file of an image (1, height, width, 3)."""
        image = np.asarray(buf)
        return bytes(imagecodecs.jpegxl_encode(image.reshape(image.shape[-3:]), **self._settings))

    def decode(self, buf: Any, out: Any = None) -> Any:
        """Returns the image in a file."""
        return imagecodecs.jpegxl_decode(bytes(buf), out=out, numthreads=1)

    def get_config(self) -> dict[str, Any]:
        """Returns what zarr stores."""
        return {"id": self.codec_id, **self._settings}


register_codec(JpegXl)
