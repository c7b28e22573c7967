"""Build of the compiled kernels, see `physim/joining.py`; all else stands in pyproject.toml.

They are compiled by the machine's C compiler. Where there is none, the build asks for the wheel
``ziglang``, which holds one, in the environment of the build alone. What MSVC is told is untried.
"""

import importlib
import shutil
import sys
from pathlib import Path
from types import ModuleType

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.errors import SetupError

HERE = Path(__file__).parent
HAS_COMPILER = sys.platform == "win32" or any(map(shutil.which, ("cc", "gcc", "clang")))
LIMITED_API = "0x030B0000"  # of Python 3.11: one wheel serves all later ones
# Bits as in Python: nothing is contracted or reordered, and no instructions are used but those that
# every processor has. An array of another width than a kernel takes is an error.
FLAGS = ["-O2", "-g0", "-ffp-contract=off", "-fno-math-errno", "-Wno-unused-function"]
FLAGS += ["-Werror=incompatible-pointer-types"]
# More of what is called is compiled into its callers: 6 s of building, steps up to 15 % faster.
FLAGS += ["-finline-limit=400", "--param=inline-unit-growth=200"]
ZIG = [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline", "-fPIC"]


class BuildKernels(build_ext):
    """Join the kernels, let Cython make C of them, and compile that."""

    def build_extensions(self) -> None:
        """Compile with the machine's own compiler, else with that of the wheel ``ziglang``."""
        from Cython.Build import cythonize
        from numpy import get_include

        folder = Path(self.build_temp)
        folder.mkdir(parents=True, exist_ok=True)
        source = folder / "_kernels.pyx"
        sys.modules["physim"] = package = ModuleType("physim")  # whose kernels are not there yet
        package.__path__ = [str(HERE / "physim")]
        join = importlib.import_module("physim.joining").joined
        try:
            text = join({"physim": HERE / "physim", "physim.controllers": HERE / "controllers"})
        except ValueError as error:
            raise SetupError(str(error)) from None
        source.write_text(text, encoding="utf-8")
        (one,) = self.extensions
        (made,) = cythonize(Extension(one.name, [str(source)]), quiet=True)
        one.sources, one.include_dirs = made.sources, [get_include()]
        msvc = self.compiler.compiler_type == "msvc"
        one.extra_compile_args = ["/O2", "/fp:precise"] if msvc else FLAGS
        if not HAS_COMPILER:
            print("no C compiler is found: the wheel ziglang compiles the kernels", file=sys.stderr)
            self.compiler.set_executables(
                compiler=ZIG, compiler_so=ZIG, linker_so=[*ZIG, "-shared"], linker_exe=ZIG
            )
        super().build_extensions()


setup(
    setup_requires=[] if HAS_COMPILER else ["ziglang>=0.13"],
    ext_modules=[
        Extension(
            "physim._kernels",
            [],
            py_limited_api=True,
            define_macros=[
                ("Py_LIMITED_API", LIMITED_API),
                ("CYTHON_LIMITED_API", "1"),
                ("NPY_NO_DEPRECATED_API", "NPY_2_0_API_VERSION"),
            ],
        )
    ],
    cmdclass={"build_ext": BuildKernels},
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
