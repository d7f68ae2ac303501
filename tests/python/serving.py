"""The real server, `lightfit serve`, as a process; and certificates for it."""

from __future__ import annotations

import json
import os
import pathlib
import re
import shutil
import subprocess
import threading
import time
import urllib.request
from typing import Any, Callable, Dict, List

import pytest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]

# Longer than anything takes on a busy machine: who waits so long waits in vain.
PATIENCE_S = 60.0


def program() -> str:
    path = os.environ.get("LIGHTFIT_PROGRAM", str(REPOSITORY / "build/release/bin/lightfit"))
    if not os.access(path, os.X_OK):
        pytest.skip(f"{path} is absent: build the target lightfit, or set LIGHTFIT_PROGRAM")
    return path


def wait_until(is_so: Callable[[], bool], what: str) -> None:
    """Until `is_so()`; AssertionError when that takes for ever."""
    end = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < end, f"{what}: not within {PATIENCE_S} s"
        time.sleep(0.02)


class Server:
    """`lightfit serve`, on a port of its own choosing unless told."""

    def __init__(self, *arguments: Any, listen: str = "127.0.0.1:0") -> None:
        self.process = subprocess.Popen(
            [program(), "serve", "--listen", listen, "--metrics", "127.0.0.1:0"]
            + [str(argument) for argument in arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.log: List[str] = []
        self._reader = threading.Thread(target=self._read_log, daemon=True)
        self._reader.start()
        self.address = self._read_start("listening on ")
        self.metrics_address = f"127.0.0.1:{self._read_start('metrics on port ')}"

    def _read_start(self, words: str) -> str:
        assert self.process.stdout is not None
        line = self.process.stdout.readline().strip()
        if not line.startswith(words):
            self.kill()
            raise AssertionError(f"lightfit serve said {line!r}; {''.join(self.log)}")
        return line[len(words) :]

    def _read_log(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self.log.append(line)

    def kill(self) -> None:
        self.process.kill()
        self._ended()

    def stop(self) -> int:
        """Drains; its exit code."""
        self.process.terminate()
        return self._ended()

    def _ended(self) -> int:
        code = self.process.wait(timeout=PATIENCE_S)
        self._reader.join(timeout=10)
        return code

    def log_lines(self) -> List[Dict[str, Any]]:
        """So far; each is a JSON object."""
        return [json.loads(line) for line in list(self.log)]

    def events(self, kind: str) -> List[Dict[str, Any]]:
        """The log's lines about "call", "drain", "tls" ..., so far."""
        return [line for line in self.log_lines() if line["event"] == kind]

    def metric(self, name: str, label: str = "") -> float:
        """What the metrics endpoint says, added up over the labels, or those with `label`
        (`method="Fit"`)."""
        with urllib.request.urlopen(f"http://{self.metrics_address}/metrics", timeout=20) as page:
            text = page.read().decode()
        pattern = rf"^{name}(?:{{(.*)}})? (\S+)$"
        samples = re.findall(pattern, text, re.MULTILINE)
        return sum(float(value) for labels, value in samples if label in labels)

    def wait_until_idle(self) -> None:
        """Until no call is under way, and none holds memory or a worker."""
        for name in ("calls_in_flight", "readback_memory_bytes", "workers_busy"):
            wait_until(lambda: self.metric(f"lightfit_{name}") == 0, f"lightfit_{name} 0")

    def num_files(self) -> int:
        """Sockets and files that it has open."""
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def peak_memory_bytes(self) -> int:
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        match = re.search(r"VmHWM:\s+(\d+) kB", status)
        assert match is not None
        return int(match.group(1)) * 1024


def make_certificates(folder: pathlib.Path) -> pathlib.Path:
    """A CA, and by it a server "lightfit.test" and a client: NAME.pem, NAME.key."""
    folder.mkdir()
    if shutil.which("openssl") is None:
        pytest.skip("openssl is absent")
    _openssl(folder, "req", "-x509", *_NEW_KEY, "-keyout", "ca.key", "-out", "ca.pem",
             "-subj", f"/CN=CA {folder.name}")
    for name in ("server", "client"):
        make_certificate(folder, name)
    return folder


def make_certificate(folder: pathlib.Path, name: str) -> None:
    """One more, NAME.pem and NAME.key, by the CA in the folder."""
    (folder / "names").write_text("subjectAltName = DNS:lightfit.test")
    _openssl(folder, "req", *_NEW_KEY, "-keyout", f"{name}.key", "-out", f"{name}.csr",
             "-subj", f"/CN={name}")
    _openssl(folder, "x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key",
             "-CAcreateserial", "-extfile", "names", "-out", f"{name}.pem")


_NEW_KEY = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")


def _openssl(folder: pathlib.Path, *words: str) -> None:
    subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)
