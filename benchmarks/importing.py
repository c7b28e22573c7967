"""Import of a 1,000 x 1,000 map, whole process: ``python benchmarks/importing.py``.

A building of ten by ten rooms, with noise, and turned so that no wall lies along the cells.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image

CELLS = 1000
RESOLUTION = 0.05
ROOM = 100
DOOR = 40
RUNS = 5


def building(noise: int) -> np.ndarray:
    """Brightness (CELLS, CELLS): ten by ten rooms joined by doors, and ``noise`` dark specks."""
    generator = np.random.default_rng(1)
    pixels = np.full((CELLS, CELLS), 254, dtype=np.uint8)
    pixels[:4] = pixels[-4:] = 0
    pixels[:, :4] = pixels[:, -4:] = 0
    for wall in range(ROOM, CELLS, ROOM):
        pixels[wall - 2 : wall + 2, :] = 0
        pixels[:, wall - 2 : wall + 2] = 0
    for a in range(0, CELLS, ROOM):
        for wall in range(ROOM, CELLS, ROOM):
            for lines in (pixels, pixels.T):
                if generator.random() < 0.8:
                    at = a + int(generator.integers(10, ROOM - DOOR - 10))
                    lines[wall - 2 : wall + 2, at : at + DOOR] = 254
    rows, columns = generator.integers(0, CELLS, (2, noise))
    pixels[rows, columns] = 0
    return pixels


def main() -> None:
    for name, noise, turned in (("rooms", 0, False), ("rooms with 3,000 specks", 3000, False),
                                ("the same, turned by 20 degrees", 3000, True)):  # fmt: skip
        image = Image.fromarray(building(noise))
        if turned:  # and shrunk to 0.7 of its size
            small, margin = round(CELLS * 0.7), round(CELLS * 0.15)
            shrunk = Image.new("L", (CELLS, CELLS))
            shrunk.paste(image.resize((small, small), Image.Resampling.NEAREST), (margin, margin))
            image = shrunk.rotate(20.0)
        with tempfile.TemporaryDirectory() as folder:
            image.save(f"{folder}/map.pgm")
            text = f"image: map.pgm\nresolution: {RESOLUTION}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n"
            Path(folder, "map.yaml").write_text(text)
            command = [sys.executable, "-m", "physim", "import", "map.yaml", "-o", "world.yaml",
                       "--robots", "5", "--robot", "fit", "--force"]  # fmt: skip
            wall, cpu = [], []
            for _ in range(RUNS):
                start, before = time.perf_counter(), os.times()
                done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
                wall.append(time.perf_counter() - start)
                after = os.times()
                cpu.append(after.children_user + after.children_system
                           - before.children_user - before.children_system)  # fmt: skip
            print(f"{name}: {statistics.median(wall):.2f} s ({min(wall):.2f} to {max(wall):.2f}), "
                  f"{statistics.median(cpu):.2f} s of processor time")  # fmt: skip
            print("".join(f"  {line.strip()[:110]}\n" for line in
                          (done.stdout + done.stderr).splitlines()[1:6]))  # fmt: skip


if __name__ == "__main__":
    main()
