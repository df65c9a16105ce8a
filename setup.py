"""`pip install .` from a checkout: CMake builds the extension module into the package; nothing is downloaded.

Offline: `/usr/bin/python3 -m pip install --no-build-isolation --no-deps .` (setuptools and pybind11 are Debian's; Debian's pip
wants --break-system-packages as well, or a virtual environment). $CMAKE_ARGS is passed on.
"""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    """Builds the one extension with CMake, as cmake --preset release does, in a folder of its own."""

    def build_extension(self, ext):
        target = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        build = pathlib.Path(self.build_temp).resolve()
        package = build / "package"
        build.mkdir(parents=True, exist_ok=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(
            ["cmake", "-S", str(ROOT), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
             "-DRETALHO_PYTHON=ON", "-DRETALHO_APP=OFF", "-DRETALHO_TESTS=OFF", "-DRETALHO_BENCH=OFF",
             f"-DPython_EXECUTABLE={sys.executable}", f"-DRETALHO_PYTHON_FOLDER={package}",
             *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "retalho_python", "--parallel", jobs], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        built = next(package.glob("_retalho*.so"))
        shutil.copy2(built, target)


setup(
    name="retalho",
    version=(ROOT / "VERSION").read_text().strip(),
    description="Smooth surfaces made of polynomial patches",
    license="Apache-2.0",
    python_requires=">=3.10",
    install_requires=["numpy"],
    packages=["retalho"],
    package_dir={"retalho": "python/retalho"},
    package_data={"retalho": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("retalho._retalho", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    zip_safe=False,
)
