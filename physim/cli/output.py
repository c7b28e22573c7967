"""Where a run writes, decided and checked before anything is computed."""

from __future__ import annotations

import os
from pathlib import Path

from physim.errors import PhysimError

FILES = ("record.h5", "video.mp4", "summary.json")


def output_folder(folder: Path, force: bool) -> Path:
    """Make the output folder and return it.

    Raises PhysimError when it holds an earlier run and ``force`` is not set, when it is a file,
    or when it cannot be written. With ``force`` the earlier run's own files are removed, others
    are left alone.
    """
    earlier = [folder / name for name in FILES if os.path.lexists(folder / name)]
    if folder.exists() and not folder.is_dir():
        raise PhysimError(f"{folder}: is a file; -o takes a folder")
    if earlier and not force:
        raise PhysimError(
            f"{folder}: holds an earlier run ({earlier[0].name}); "
            "use --force to write over it, or -o for another folder"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(13, "Permission denied")
        for file in earlier:
            file.unlink()
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be written ({error.strerror})") from None
    return folder


def new_file(path: Path, force: bool) -> None:
    """Raise PhysimError where something exists already and ``force`` is not set."""
    if path.is_dir():
        raise PhysimError(f"{path}: is a folder; -o takes a file")
    if os.path.lexists(path) and not force:
        raise PhysimError(f"{path}: exists; use --force to write over it, or -o for another file")


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all. Raises PhysimError when it cannot be written."""
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise PhysimError(f"{path}: cannot be written ({error.strerror})") from None
