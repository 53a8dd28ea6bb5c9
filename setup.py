"""The Python package of mindahl, for pip.

    pip install --no-index --no-deps --no-build-isolation .

CMake builds the extension from this tree; where MINDAHL_PYTHON_BUILD_DIR names a package that is built
already, build/ci/python/package, it is taken from there. Nothing is downloaded.

A wheel has beside its extension what that needs and a Linux need not have, if all of it is under a
licence that asks for its text alone; these texts are in mindahl/licences. Debian's Ceres needs
SuiteSparse, which is under the GPL: a wheel with that is for systems that have Ceres, and bundles
nothing. With CMAKE_PREFIX_PATH=DIR of `scripts/ceres.sh DIR`, Ceres without SuiteSparse, a wheel is
complete.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(mindahl VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())

# Libraries that every Linux with a Python of this kind has, by the policy of manylinux (PEP 600).
SYSTEM = re.compile(r"(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|util|gcc_s|stdc\+\+))\.so.*")
BUNDLED = re.compile(r"lib(fmt|z|md)\.so.*")  # MIT, Zlib, BSD
# Debian packages whose headers are compiled into the extension.
COMPILED = ("libceres-dev", "libeigen3-dev", "nlohmann-json3-dev", "libcli11-dev", "libtomlplusplus-dev",
            "pybind11-dev", "libfmt-dev", "zlib1g-dev")


def bundle(extension, package):
    """Copies the libraries that the extension needs beside it, where its RPATH, $ORIGIN/libs, finds
    them, and the texts of the licences, where Debian's packages have them."""
    needed = {}
    if sys.platform == "linux":  # elsewhere auditwheel's relatives do so
        listed = subprocess.run(["ldd", str(extension)], check=True, capture_output=True, text=True)
        needed = {name: path for name, path in re.findall(r"^\s*(\S+) => (\S+) \(", listed.stdout, re.M)
                  if not SYSTEM.fullmatch(name)}
    others = sorted(name for name in needed if not BUNDLED.fullmatch(name))
    if others:
        print(f"mindahl: bundles no library, for it needs {', '.join(others)} of the system")
        needed = {}
    for folder in ("libs", "licences"):
        shutil.rmtree(package / folder, ignore_errors=True)
        (package / folder).mkdir()
    for name, path in needed.items():
        shutil.copy2(Path(path).resolve(), package / "libs" / name)
    for name in COMPILED:
        text = Path("/usr/share/doc", name, "copyright")
        if text.exists():
            shutil.copy(text, package / "licences" / f"{name}.txt")


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        target = Path(self.get_ext_fullpath(extension.name)).resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        built = os.environ.get("MINDAHL_PYTHON_BUILD_DIR")
        package = Path(built) if built else self.build_package()
        libraries = sorted((package / "mindahl").glob("_mindahl*.so"))
        if len(libraries) != 1:
            raise RuntimeError(f"{package}/mindahl holds {len(libraries)} extensions: build it anew")
        shutil.copy2(libraries[0], target)
        shutil.copy2(package / "mindahl" / "_sections.pyi", target.parent)
        bundle(target, target.parent)

    def build_package(self):
        build = Path(self.build_temp).resolve()
        subprocess.run(
            ["cmake", "-S", str(ROOT), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release",
             "-DMINDAHL_BUILD_PYTHON=ON", "-DMINDAHL_BUILD_TESTS=OFF", "-DMINDAHL_BUILD_EXAMPLES=OFF",
             "-DMINDAHL_INSTALL=OFF", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=0",
             f"-DMINDAHL_PYTHON={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "mindahl_python_package",
                        "--parallel", str(os.cpu_count() or 1)], check=True)
        return build / "python" / "package"


setup(
    version=VERSION.group(1),
    ext_modules=[Extension("mindahl._mindahl", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    zip_safe=False,
)
