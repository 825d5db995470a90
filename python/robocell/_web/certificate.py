"""A certificate of this machine for https, made by openssl.

Browsers give a page the orientation of a phone over https alone. No authority vouches for this
certificate, so the browser asks once whether to trust it.
"""

from __future__ import annotations

import ipaddress
import shutil
import socket
import subprocess
from pathlib import Path

from robocell._core import IoError

DAYS = 30


def make_certificate(folder: Path, host: str) -> tuple[Path, Path]:
    """Writes a certificate for a host and its key, and returns both files.

    Raises:
        IoError: There is no openssl, or it failed.
    """
    openssl = shutil.which("openssl")
    if openssl is None:
        raise IoError("--tls needs the program openssl: sudo apt install openssl")
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    command = [openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]
    command += ["-nodes", "-days", str(DAYS), "-subj", "/CN=robocell", "-addext"]
    command += [f"subjectAltName={','.join(_names(host))}"]
    command += ["-keyout", str(key), "-out", str(certificate)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise IoError(f"openssl could not make a certificate: {done.stderr.strip()[-300:]}")
    key.chmod(0o600)
    return certificate, key


def _names(host: str) -> list[str]:
    """Returns the names by which browsers call the host."""
    names = [f"DNS:{socket.gethostname()}", "DNS:localhost", "IP:127.0.0.1"]
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return [*names, f"DNS:{host}"]
    if address.is_unspecified or str(address) == "127.0.0.1":
        return names
    return [*names, f"IP:{address}"]
