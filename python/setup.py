"""Adds the generated and the compiled part to the package, from a build of CMake's.

LIGHTFIT_BUILD_DIR names a finished build; without it build/release of this checkout is brought up
to date.
"""

import os
import pathlib
import shutil
import subprocess

import setuptools
from setuptools.command.build_py import build_py

ROOT = pathlib.Path(__file__).resolve().parent.parent


def built_package() -> pathlib.Path:
    """The folder of the whole package in a build."""
    given = os.environ.get("LIGHTFIT_BUILD_DIR")
    build = pathlib.Path(given) if given else ROOT / "build" / "release"
    if not given:
        subprocess.run(["cmake", "--preset", "release"], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", build, "--target", "lightfit_python"], check=True)
    package = build / "python" / "lightfit"
    for wanted in ("_native*.so", "v1/service_pb2.py"):
        if not list(package.glob(wanted)):
            raise SystemExit(
                f"{package}/{wanted} is absent: cmake --build {build} --target lightfit_python"
            )
    return package


class BuildWithNative(build_py):
    def run(self) -> None:
        super().run()
        package = built_package()
        target = pathlib.Path(self.build_lib) / "lightfit"
        for pattern in ("_native*.so", "v1/*_pb2*.py", "v1/*_pb2.pyi"):
            for source in package.glob(pattern):
                destination = target / source.relative_to(package)
                destination.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, destination)


class PlatformDistribution(setuptools.Distribution):
    def has_ext_modules(self) -> bool:
        return True


setuptools.setup(cmdclass={"build_py": BuildWithNative}, distclass=PlatformDistribution)
