"""Which of our kernels Highway picks on this processor: speeds of lanes depend on it."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from pathlib import Path
from unittest import mock

from table import Row

# cmake/RobocellBenchmarks.cmake builds this library.
_ONLY_AVX2 = Path(__file__).resolve().parents[1] / "build" / "release" / "libonly_avx2.so"
_SSE4 = ("ssse3", "sse4_1", "sse4_2", "pclmulqdq", "aes")
_AVX2 = (*_SSE4, "avx", "avx2", "fma", "f16c", "bmi1", "bmi2", "abm")
_AVX512 = (*_AVX2, "avx512f", "avx512vl", "avx512dq", "avx512bw", "avx512cd")
# What Highway wants for a set, as Linux names it; best first. Those that kernels are made for:
# HWY_DISABLED_TARGETS in src/robocell/kinematics/lane_kernel.cc.
KERNELS = {"AVX-512": _AVX512, "AVX2": _AVX2}


def instruction_set(cpuinfo: str | None = None) -> str:
    """The longest registers that kernels use here: "AVX-512", "AVX2", or "plain x86-64".

    Args:
        cpuinfo: text of /proc/cpuinfo; None reads this machine's.

    Returns:
        Its name; of another architecture the architecture's.
    """
    if platform.machine() != "x86_64":
        return f"plain {platform.machine()}"
    text = Path("/proc/cpuinfo").read_text() if cpuinfo is None else cpuinfo
    flags = next((line for line in text.splitlines() if line.startswith("flags")), "").split()
    fitting = (name for name, needed in KERNELS.items() if set(needed) <= set(flags))
    return next(fitting, "plain x86-64")


def compiler_flags() -> tuple[str, ...]:
    """For programs that shall have the instructions that our kernels have here, and no others."""
    if os.environ.get("LD_PRELOAD") != str(_ONLY_AVX2):
        return ("-march=native",)
    return ("-march=native", "-mno-avx512f")  # the rest of AVX-512 needs that


def with_avx2(rows: Callable[[Path], list[Row]]) -> Callable[[Path], list[Row]]:
    """A benchmark with the kernels that a processor without AVX-512 has.

    It has no rows where there is nothing wider that could be left alone.
    """

    def narrowed(folder: Path) -> list[Row]:
        if instruction_set() != "AVX-512":
            return []
        with mock.patch.dict(os.environ, LD_PRELOAD=str(_ONLY_AVX2)):
            return rows(folder)

    return narrowed
