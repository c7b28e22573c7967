"""Try the oldest libraries that pyproject.toml admits: ``python -m tests.lowest FOLDER``.

Makes a new environment in FOLDER (which must not be there yet) with every dependency, and those of
`physim[import,study]`, at its lower bound, all from a package registry, and uses each command once.
Exit code 1 where one fails.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
EXTRAS = ("import", "study")
COMMANDS = (
    "check s_bend",
    "preview merging -o preview.png",
    "run straight --no-video -o run",
    "summary run/record.h5",
    "validate run/record.h5",
    "plot run/record.h5 -o plots",
    "page run/record.h5 -o page.html",
    "video run/record.h5 -o slide.gif --from 1 --to 2",
    "sweep random_road --seeds 1:3 --set time.duration=5 --parquet -o sweep",
    "report sweep",
    "sweep random_road --seeds 1:3 --controller mode_switching,path_following "
    "--set time.duration=5 -o compared",
    "compare compared --by controller",
    "falsify straight --budget 4 --set time.duration=5 -o falsified",
    "crashtest --cases 100",
    "import {samples}/hall.svg --scale 0.1 -o hall.yaml",
)


def lowest(project: Path = ROOT / "pyproject.toml") -> list[str]:
    """``NAME==VERSION`` for the lower bound of every dependency, those of `EXTRAS` too."""
    told = tomllib.loads(project.read_text())["project"]
    wanted = list(told["dependencies"])
    for extra in EXTRAS:
        wanted += told["optional-dependencies"][extra]
    found = [re.match(r"([\w.-]+)>=([\w.]+)", one) for one in wanted]
    return [f"{one[1]}=={one[2]}" for one in found if one]


def main() -> int:
    """Install, then try every command."""
    parser = argparse.ArgumentParser(prog="python -m tests.lowest", description=__doc__)
    parser.add_argument("folder", type=Path)
    folder: Path = parser.parse_args().folder.absolute()
    folder.mkdir(parents=True)
    made = folder / "env"
    subprocess.run([sys.executable, "-m", "venv", made], check=True)
    pip = [made / "bin" / "python", "-m", "pip", "install", "--quiet"]
    subprocess.run([*pip, f"{ROOT}[{','.join(EXTRAS)}]", *lowest()], check=True, cwd=folder)
    failed = 0
    for command in COMMANDS:
        words = command.format(samples=ROOT / "tests/authoring/importing/samples").split()
        done = subprocess.run(
            [made / "bin" / "physim", *words], cwd=folder, capture_output=True, text=True
        )
        print(f"{'ok' if done.returncode == 0 else done.returncode}: physim {command}", flush=True)
        if done.returncode:
            failed += 1
            print(done.stderr[-2000:])
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
