"""What processes take."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

from robocell._generation.procfs import (
    MemoryWatch,
    _with_parent,
    children,
    children_peak_bytes,
    peak_bytes,
)

LARGE = 64 << 20
HOLD = f"""
held = bytearray({LARGE})
held[::4096] = b'x' * len(held[::4096])
print(flush=True)
input()
"""


def start() -> subprocess.Popen[bytes]:
    """A process that holds some memory until its input ends."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout
    process.stdout.readline()
    return process


def test_memory_of_live_children_is_counted():
    others = children_peak_bytes()  # that earlier tests of this process left running
    with MemoryWatch(children_peak_bytes) as watch:
        processes = [start(), start()]
        assert {process.pid for process in processes} <= set(children(os.getpid()))
        assert set(children(os.getpid())) <= set(_with_parent(os.getpid()))
        largest = peak_bytes(processes[0].pid)
        assert LARGE < largest < 1.5 * LARGE
        until = time.monotonic() + 10
        while watch.bytes < others + 2 * LARGE and time.monotonic() < until:
            time.sleep(0.01)
        for process in processes:
            process.communicate()
    assert 2 * LARGE < watch.bytes - others < 3 * LARGE
    assert not {process.pid for process in processes} & set(children(os.getpid()))


def test_a_child_before_exec_is_not_counted():
    pid = os.fork()
    if pid == 0:
        time.sleep(10)
        os._exit(0)
    try:
        assert pid not in children(os.getpid())
    finally:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)


def test_peak_memory_lasts_as_long_as_its_process():
    before = peak_bytes()
    held = bytearray(LARGE)
    held[::4096] = b"x" * len(held[::4096])
    del held
    assert peak_bytes() >= before
    assert peak_bytes() > LARGE
    process = start()
    process.communicate()
    assert peak_bytes(process.pid) == 0


def test_the_age_of_a_process_includes_the_time_before_python():
    code = (
        "import time; from robocell._generation import procfs; "
        "time.sleep(0.5); print(procfs.age_s())"
    )
    began = time.monotonic()
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 0.5 < float(ran.stdout) < time.monotonic() - began + 0.02  # the system's clock ticks
