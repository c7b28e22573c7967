"""Pictures of the gallery: a still and a short film of every shipped world, by physim itself.

python -m benchmarks.gallery [WORLD ...]

Runs the worlds and writes docs/gallery/WORLD.webp and WORLD.mp4, of ten_robots also
media/ten_robots.png and .mp4; all of it in some five minutes of processor time. What ``physim
video`` writes is coded once more, and smaller, as it is kept with the sources. Worlds that show
avoidance are seen beside themselves without it. Exit codes: 0 made, 1 a command failed, 2 no such
world.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import imageio_ffmpeg
import PIL.Image

from benchmarks.avoidance import SHOWS_AVOIDANCE, WITHOUT
from physim.world.file.files import shipped_worlds

ROOT = Path(__file__).parents[1]
GALLERY, MEDIA = ROOT / "docs/gallery", ROOT / "media"
WIDTH = 960
"""[px] of what the gallery shows"""
FPS = 15
SIZE, SIZE_OF_BOTH = 180_000, 250_000
"""[bytes] of a film, at most; all of the gallery together takes 0.23 MB a world"""
MEDIA_SIZE = 1_500_000
FACTORS = range(30, 42, 2)
"""Constant rate factors of H.264 to try; the first one that makes a film small enough is taken."""


class Shot(NamedTuple):
    """What is shown of a world."""

    begin: float
    """[s] of simulated time, as `end` and `still`"""
    end: float
    speed: float
    """simulated seconds a second of film"""
    still: float
    seed: int | None = None
    """in place of the world's own"""


SHOTS = {
    "straight": Shot(0.0, 25.5, 2.0, 15.0),
    "single_robot": Shot(0.0, 112.0, 8.0, 100.0),
    "three_robots": Shot(38.0, 53.0, 1.5, 45.2),
    "ten_robots": Shot(46.0, 66.0, 2.0, 56.0),
    "crowded_start": Shot(0.0, 22.0, 2.0, 9.0),
    "nonconvex": Shot(20.0, 42.0, 2.0, 30.6),
    # With its own seed the robots do not touch in either run.
    "random_road": Shot(0.0, 22.0, 2.0, 2.6, seed=2),
    "doorway": Shot(3.0, 30.0, 2.0, 16.0),
    "narrowing": Shot(5.0, 39.0, 3.0, 22.0),
    "merging": Shot(6.0, 32.0, 2.0, 22.0),
    "crossing": Shot(4.0, 28.0, 2.0, 18.0),
    "s_bend": Shot(4.0, 46.0, 4.0, 26.0),
    "u_turn": Shot(6.0, 42.0, 3.0, 28.0),
    "roundabout": Shot(20.0, 60.0, 4.0, 40.0),
    "warehouse": Shot(4.0, 60.0, 5.0, 40.0),
    "jam": Shot(8.0, 28.0, 2.0, 24.0),
    "hundred_robots": Shot(24.0, 54.0, 3.0, 46.0),
    "sliding_door": Shot(4.0, 32.0, 2.0, 13.5),
    "crossing_cart": Shot(12.0, 36.0, 2.0, 20.0),
    "cars": Shot(4.0, 34.0, 2.0, 16.0),
    "mixed_team": Shot(2.0, 46.0, 4.0, 22.0),
    "noisy_ten_robots": Shot(46.0, 66.0, 2.0, 56.0),
    "lossy_ten_robots": Shot(46.0, 66.0, 2.0, 56.0),
    "thousand_robots": Shot(23.0, 43.0, 2.0, 40.0),
}
MEDIA_SHOT = Shot(40.0, 72.0, 2.0, 56.0)


def physim(*words: object) -> None:
    """Run a command of physim. Raises CalledProcessError; a missed `expect` is no failure."""
    command = [sys.executable, "-m", "physim", *map(str, words), "--quiet"]
    code = subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL).returncode
    if code not in (0, 1):
        raise subprocess.CalledProcessError(code, command)


def records(name: str, shot: Shot, folder: Path) -> list[Path]:
    """Run a world, and beside it without avoidance where both are shown."""
    arms = {"with": [], "without": ["--set", WITHOUT]}
    labels = list(arms) if name in SHOWS_AVOIDANCE else [name]
    seed = [] if shot.seed is None else ["--seed", shot.seed]
    for label in labels:
        given = [*arms.get(label, []), *seed]
        physim("run", name, "--no-video", "-o", folder / label, *given)
    return [folder / label for label in labels]


def film(of: list[Path], shot: Shot, to: Path, width: int, most: int) -> None:
    """Write an MP4 of at most so many bytes, or the coarsest there is."""
    raw = of[0].parent / f"{to.parent.name}.mp4"
    times = ("--from", shot.begin, "--to", shot.end, "--speed", shot.speed)
    physim("video", *of, *times, "--fps", FPS, "-o", raw)
    for factor in FACTORS:
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-y", "-i", raw]
        command += ["-vf", f"scale={width}:-2:flags=lanczos", "-c:v", "libx264", "-crf", factor]
        command += ["-preset", "slow", "-tune", "animation", "-pix_fmt", "yuv420p"]
        subprocess.run([*map(str, command), "-movflags", "+faststart", to], check=True)
        if to.stat().st_size <= most:
            break
    print(f"{to.relative_to(ROOT)}: {to.stat().st_size / 1e3:.0f} kB, factor {factor}", flush=True)


def make(name: str) -> None:
    """Write the pictures of a world."""
    shot = SHOTS[name]
    with tempfile.TemporaryDirectory() as there:
        of, png = records(name, shot, Path(there)), Path(there) / "still.png"
        at = ("--at", shot.still, "--speed", shot.speed)
        physim("video", *of, *at, "--width", WIDTH, "-o", png)
        PIL.Image.open(png).save(GALLERY / f"{name}.webp", quality=80, method=6)
        most = SIZE_OF_BOTH if len(of) > 1 else SIZE
        film(of, shot, GALLERY / f"{name}.mp4", WIDTH, most)
        if name == "ten_robots":
            physim("video", *of, *at, "-o", MEDIA / f"{name}.png", "--force")
            film(of, MEDIA_SHOT, MEDIA / f"{name}.mp4", 1280, MEDIA_SIZE)


def main() -> int:
    """Run the program; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.gallery", description=__doc__.splitlines()[0]
    )
    parser.add_argument("worlds", nargs="*", metavar="WORLD", help="shipped worlds (all)")
    names = parser.parse_args().worlds or list(shipped_worlds())
    if unknown := [name for name in names if name not in SHOTS]:
        print(f"no shot in {Path(__file__).name} of: {', '.join(unknown)}", file=sys.stderr)
        return 2
    try:
        for name in names:
            make(name)
    except subprocess.CalledProcessError as fault:
        print(fault, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
