"""How setuptools gets what a wheel holds: from CMake."""
import os
import pathlib
import re
import subprocess
import sys

from setuptools.command.build_py import build_py

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # before setuptools 70
    from wheel.bdist_wheel import bdist_wheel

SOURCE = pathlib.Path(__file__).resolve().parents[1]
VERSION = re.search(r'kVersion = "(.+?)"', (SOURCE / "src/base/util/version.h").read_text()).group(1)
OPTIONS = {
    "CMAKE_BUILD_TYPE": "Release",
    "Python_EXECUTABLE": sys.executable,
    "TRILENS_PYTHON": "ON",
    "TRILENS_PYTHON_WHEEL": "ON",
    "TRILENS_PYTHON_SITE": ".",
    "TRILENS_TESTS": "OFF",
    "TRILENS_BENCH": "OFF",
    "TRILENS_INSTALL": "OFF",
}


class BuildByCMake(build_py):
    """Builds the module and installs it, with its plain Python, where setuptools packs it from.
    CMAKE_ARGS in the environment adds options."""

    def run(self):
        build = pathlib.Path(self.get_finalized_command("build").build_temp).resolve()
        options = [f"-D{name}={value}" for name, value in OPTIONS.items()] + os.environ.get("CMAKE_ARGS", "").split()
        subprocess.check_call(["cmake", "-G", "Ninja", "-S", SOURCE, "-B", build, *options])
        subprocess.check_call(["cmake", "--build", build, "--target", "trilens_python"])
        subprocess.check_call(
            ["cmake", "--install", build, "--prefix", pathlib.Path(self.build_lib).resolve(), "--component", "python"])


class PlatformWheel(bdist_wheel):
    """A wheel of this Python and this machine."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False
