"""Builds the package for pip (PEP 517 and 660), from a build of CMake's and the standard library
alone: nothing is fetched for it.

LIGHTFIT_BUILD_DIR names a finished build; without it build/release of this checkout is brought up
to date.
"""

from __future__ import annotations

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile
from typing import Any, Dict, List, Optional

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parent

PARTS = ("*.py", "py.typed", "_native*.so", "v1/*.py", "v1/*.pyi")
METADATA = """Metadata-Version: 2.1
Name: lightfit
Version: {version}
Summary: Fits shadow-map matrices to the image: read-backs as numpy arrays in, light matrices out
License: Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy>=1.20
Requires-Dist: protobuf>=3.20
Requires-Dist: grpcio>=1.50
Description-Content-Type: text/markdown

{readme}"""


def build_wheel(
    wheel_directory: str,
    config_settings: Optional[Dict[str, Any]] = None,
    metadata_directory: Optional[str] = None,
) -> str:
    package = built_package()
    files = sorted(path for part in PARTS for path in package.glob(part))
    content = {f"lightfit/{path.relative_to(package)}": path.read_bytes() for path in files}
    return write_wheel(wheel_directory, package, content)


def build_editable(
    wheel_directory: str,
    config_settings: Optional[Dict[str, Any]] = None,
    metadata_directory: Optional[str] = None,
) -> str:
    """The build's own package, whose sources are links to this folder's."""
    package = built_package()
    return write_wheel(wheel_directory, package, {"lightfit.pth": f"{package.parent}\n".encode()})


def build_sdist(sdist_directory: str, config_settings: Optional[Dict[str, Any]] = None) -> str:
    raise SystemExit(
        "lightfit: its compiled part is built from the whole checkout, so that there is no source "
        "archive of this folder alone: pip wheel ./python, or pip install ./python"
    )


def prepare_metadata_for_build_wheel(
    metadata_directory: str, config_settings: Optional[Dict[str, Any]] = None
) -> str:
    info = f"lightfit-{version_of(built_package())}.dist-info"
    folder = pathlib.Path(metadata_directory)
    (folder / info).mkdir()
    for name, data in dist_info(info).items():
        (folder / name).write_bytes(data)
    return info


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel


def get_requires_for_build_wheel(config_settings: Optional[Dict[str, Any]] = None) -> List[str]:
    return []


get_requires_for_build_editable = get_requires_for_build_wheel
get_requires_for_build_sdist = get_requires_for_build_wheel


def built_package() -> pathlib.Path:
    """The folder of the whole package in a build."""
    given = os.environ.get("LIGHTFIT_BUILD_DIR")
    build = pathlib.Path(given).resolve() if given else ROOT / "build" / "release"
    target = f"cmake --build {build} --target lightfit_python"
    if not given:
        # pip's own variables are not for the Pythons that CMake runs.
        environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PIP_"))}
        for words in (["cmake", "--preset", "release"], target.split(" ")):
            try:
                subprocess.run(words, cwd=ROOT, env=environment, check=True)
            except (OSError, subprocess.CalledProcessError) as error:
                raise SystemExit(
                    f"lightfit: {' '.join(words)}: {error}; ./run build release python installs "
                    "what it takes, or LIGHTFIT_BUILD_DIR names a finished build"
                ) from None
    package = build / "python" / "lightfit"
    for wanted in ("_native*.so", "_version.py", "v1/service_pb2.py"):
        if not list(package.glob(wanted)):
            raise SystemExit(f"lightfit: {package}/{wanted} is absent: {target}")
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    if not (package / f"_native{suffix}").exists():
        found = next(package.glob("_native*.so")).name
        raise SystemExit(
            f"lightfit: {package}/{found} is not for this Python, {sys.executable}, which wants "
            f"_native{suffix}: use the Python that it was built for, or cmake --preset release "
            f"-DPython_EXECUTABLE={sys.executable}"
        )
    return package


def write_wheel(folder: str, package: pathlib.Path, content: Dict[str, bytes]) -> str:
    version = version_of(package)
    info = f"lightfit-{version}.dist-info"
    content = {**content, **dist_info(info)}
    record = "".join(
        f"{name},sha256={_digest(data)},{len(data)}\n" for name, data in content.items()
    )
    content[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    wheel = f"lightfit-{version}-{tag()}.whl"
    with zipfile.ZipFile(os.path.join(folder, wheel), "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in content.items():
            file.writestr(name, data)
    return wheel


def dist_info(info: str) -> Dict[str, bytes]:
    """What every wheel says of itself; info: the folder, lightfit-VERSION.dist-info."""
    version = info[len("lightfit-") : -len(".dist-info")]
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    wheel = f"Wheel-Version: 1.0\nGenerator: lightfit\nRoot-Is-Purelib: false\nTag: {tag()}\n"
    return {
        f"{info}/METADATA": METADATA.format(version=version, readme=readme).encode(),
        f"{info}/WHEEL": wheel.encode(),
        f"{info}/LICENSE": (ROOT / "LICENSE").read_bytes(),
    }


def version_of(package: pathlib.Path) -> str:
    words = (package / "_version.py").read_text(encoding="utf-8")
    found = re.search(r'__version__ = "(.*)"', words)
    if found is None:
        raise SystemExit(f"lightfit: {package}/_version.py: says no version")
    return found.group(1)


def tag() -> str:
    """Of the Python that runs this, which the compiled part is for."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{python}-{python}{getattr(sys, 'abiflags', '')}-{platform}"


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
