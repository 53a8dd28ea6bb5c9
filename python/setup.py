"""The wheel of mindahl.

The extension is built by CMake from the tree around this folder; where MINDAHL_PYTHON_BUILD_DIR
names a package that is built already, build/ci/python/package, it is taken from there. The libraries
that the extension needs, Ceres' and others, go into the wheel beside it. Nothing is downloaded: pip install --no-index --no-deps --no-build-isolation ./python
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent.parent
VERSION = re.search(r"project\(mindahl VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())


# Libraries that every Linux with a Python of this kind has, by the policy of manylinux (PEP 600).
SYSTEM = re.compile(r"(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|util|gcc_s|stdc\+\+))\.so.*")


def bundle_libraries(extension, folder):
    """Copies the libraries that the extension needs beside it, where its RPATH, $ORIGIN/libs, finds
    them: the wheel needs no package of the system."""
    listed = subprocess.run(["ldd", str(extension)], check=True, capture_output=True, text=True)
    shutil.rmtree(folder, ignore_errors=True)
    for name, path in re.findall(r"^\s*(\S+) => (\S+) \(", listed.stdout, re.M):
        if not SYSTEM.fullmatch(name):
            folder.mkdir(exist_ok=True)
            shutil.copy2(Path(path).resolve(), folder / name)


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
        bundle_libraries(target, target.parent / "libs")

    def build_package(self):
        build = Path(self.build_temp).resolve()
        subprocess.run(
            ["cmake", "-S", str(ROOT), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release",
             "-DMINDAHL_BUILD_PYTHON=ON", "-DMINDAHL_BUILD_TESTS=OFF", "-DMINDAHL_BUILD_EXAMPLES=OFF",
             "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12",
             f"-DMINDAHL_PYTHON={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "mindahl_python", "--parallel"],
                       check=True)
        return build / "python" / "package"


setup(
    version=VERSION.group(1),
    ext_modules=[Extension("mindahl._mindahl", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    zip_safe=False,
)
