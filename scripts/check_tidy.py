"""Runs clang-tidy on every source of the release build.

    scripts/check_tidy.py JOBS

In: build/release as configured, its generated headers, and .clang-tidy. Out: what clang-tidy says of
sources that do not pass; exit status 1 when there is one. The count of files done goes to stderr.

A source that passed is not looked at again until it, a header of the project that it includes, its
flags or the settings change, or the schema where it includes messages: build/lint/ keeps one empty
file, named by their hash, for each pass.

On two cores the whole takes half an hour, and nearly all of it are other people's headers: parsing
GoogleTest, Eigen or gRPC takes 2 to 5 s, matching the checks against them twice as long. What made it
twice that again was the static analyzer on tests, which follows every path through the expansions
of EXPECT_: 10 to 20 s for a file (tests/geometry/camera_test.cc 24 s with it, 9 s without), to prove
that a test which runs in `./run test` under three sanitizers dereferences no null pointer. It
looks at all other sources (1 to 2 s each); all other checks look at all sources.
"""

import concurrent.futures
import hashlib
import json
import pathlib
import re
import shlex
import subprocess
import sys
import threading
from typing import Dict, List, Set

TIDY = "clang-tidy-14"
ROOT = pathlib.Path.cwd()
RELEASE = ROOT / "build" / "release"
LINT = ROOT / "build" / "lint"
NO_ANALYZER = ["--checks=-clang-analyzer-*"]  # on top of .clang-tidy, for tests/

# Precompiled headers and memory settings are g++'s. Without the former a source is also seen to
# include what it uses.
PRECOMPILED = re.compile(r" (-Winvalid-pch|-fpch-preprocess|--param ggc-\S+|-include \S+cmake_pch\.hxx)(?= )")
INCLUDE = re.compile(rb'^\s*#\s*include\s+["<]([^">]+)[">]', re.MULTILINE)
NOISE = re.compile(r"^(\d+ warnings? (generated|treated)|Suppressed \d+ warnings|Use -header-filter)")


class Sources:
    """The project's files as they include each other."""

    def __init__(self) -> None:
        self._includes: Dict[pathlib.Path, List[str]] = {}
        self._hashes: Dict[pathlib.Path, str] = {}
        protos = sorted(ROOT.glob("*/**/*.proto"))
        self._schema = hashlib.sha256(b"".join(map(pathlib.Path.read_bytes, protos))).hexdigest()

    def _read(self, path: pathlib.Path) -> None:
        if path not in self._includes:
            text = path.read_bytes()
            self._hashes[path] = hashlib.sha256(text).hexdigest()
            self._includes[path] = [name.decode() for name in INCLUDE.findall(text)]

    def key(self, source: pathlib.Path) -> str:
        """Of all that `source` reads from the project; the schema stands for generated headers."""
        reads_schema = False
        seen: Set[pathlib.Path] = set()
        waiting = [source]
        while waiting:
            path = waiting.pop()
            if path in seen:
                continue
            seen.add(path)
            self._read(path)
            for name in self._includes[path]:
                reads_schema = reads_schema or name.endswith(".pb.h")
                for folder in (ROOT, ROOT / "tests", path.parent):
                    if (folder / name).is_file():
                        waiting.append((folder / name).resolve())
                        break
        lines = [f"{path} {self._hashes[path]}" for path in sorted(seen)]
        if reads_schema:
            lines.append(self._schema)
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def commands() -> Dict[pathlib.Path, str]:
    """Each source, once, and how it is compiled; also written for clang-tidy to read."""
    entries = {}
    for entry in json.loads((RELEASE / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(ROOT) and not path.is_relative_to(ROOT / "build"):
            entry["command"] = PRECOMPILED.sub("", entry["command"])
            entries.setdefault(path, entry)
    (LINT / "compile_commands.json").write_text(json.dumps(list(entries.values())))
    return {path: entry["command"] for path, entry in entries.items()}


def options(source: pathlib.Path) -> List[str]:
    return NO_ANALYZER if source.is_relative_to(ROOT / "tests") else []


def check(source: pathlib.Path) -> str:
    """What clang-tidy has against it, "" when nothing."""
    done = subprocess.run(
        ["nice", TIDY, "--quiet", "-p", LINT, *options(source), source],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
    )
    if done.returncode == 0:
        return ""
    return "\n".join(line for line in done.stdout.splitlines() if not NOISE.match(line))


def main() -> int:
    LINT.mkdir(exist_ok=True)
    version = subprocess.run([TIDY, "--version"], stdout=subprocess.PIPE, check=True).stdout
    settings = (ROOT / ".clang-tidy").read_bytes() + version
    sources = Sources()
    pending = {}
    for path, command in sorted(commands().items()):
        flags = " ".join([*shlex.split(command), *options(path)]).encode()
        key = hashlib.sha256(settings + flags + sources.key(path).encode()).hexdigest()[:32]
        if not (LINT / key).exists():
            pending[path] = LINT / key
    print(f"{len(pending)} files to look at", file=sys.stderr)

    num_done = num_faults = 0
    lock = threading.Lock()

    def check_one(path: pathlib.Path) -> None:
        nonlocal num_done, num_faults
        report = check(path)
        with lock:
            num_done += 1
            if report:
                num_faults += 1
                print(report, flush=True)
            else:
                pending[path].touch()
            print(f"[{num_done}/{len(pending)}] {path.relative_to(ROOT)}", file=sys.stderr)

    with concurrent.futures.ThreadPoolExecutor(int(sys.argv[1])) as pool:
        try:
            list(pool.map(check_one, pending))
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise
    return 1 if num_faults else 0


if __name__ == "__main__":
    sys.exit(main())
