"""GIF, WebP and stills: what programs that show them find in the files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from PIL import Image

from physim.drawing import palette
from physim.drawing.video import frame_at, render, still
from physim.errors import PhysimError
from tests.helpers import facts, inside

resized, MOST, Indexer = inside("physim.drawing.video", "resized", "MOST", "Indexer")
chosen_colours = inside("physim.drawing.video", "chosen_colours")


def decoded(path: Path) -> tuple[list[Any], list[int]]:
    """Frames (h, w, 3), and how long each is seen [ms]."""
    frames, lasts = [], []
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB")))
            lasts.append(film.info["duration"])
    return frames, lasts


@pytest.mark.parametrize(("kind", "fps"), [("gif", 10.0), ("gif", 25.0), ("webp", 30.0)])
def test_frames_are_seen_as_long_as_they_should(
    made: Callable[..., Any], tmp_path: Path, kind: str, fps: float
) -> None:
    path = tmp_path / f"film.{kind}"
    count = render(made(3), path, fps=fps, speed=2.0, width=320)
    frames, lasts = decoded(path)
    assert len(frames) == 1 + round(2.0 * fps), "the last picture is there once"
    assert frames[0].shape == (180, 320, 3)
    assert abs(sum(lasts) - 1000.0 * count / fps) <= 1.0
    assert max(lasts[:-1]) - min(lasts[:-1]) <= 1
    assert lasts[-1] == pytest.approx(1500.0 + lasts[0], abs=500.0 / fps + 2.0)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_a_frame_is_the_drawn_one(made: Callable[..., Any], tmp_path: Path, kind: str) -> None:
    record, path = made(3), tmp_path / f"film.{kind}"
    render(record, path, fps=5.0, speed=1.0, width=1280, end=0.8)
    shown = decoded(path)[0][0].astype(int)
    drawn = frame_at(record, 0.0, fps=5.0, speed=1.0)
    assert np.abs(shown - drawn).mean() < 0.5
    for colour in (palette.SAFE_AREA, palette.DANGER_AREA, palette.OUTSIDE, palette.CONTACT):
        flat = (drawn == colour).all(axis=2)
        assert flat.sum() > 30
        assert (shown[flat] == colour).all(), "what means something has its own colour"


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_the_same_record_gives_the_same_file(
    made: Callable[..., Any], tmp_path: Path, kind: str
) -> None:
    for name in ("a", "b"):
        render(made(3), tmp_path / f"{name}.{kind}", fps=5.0, speed=2.0, width=320)
    assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()


def test_rare_colours_are_kept() -> None:
    image = np.random.default_rng(1).integers(0, 256, (300, 300, 3)).astype(np.uint8)
    image[:150] = palette.WHITE
    image[150, 3] = palette.CONTACT
    colours = chosen_colours([image], [palette.CONTACT])
    assert len(colours) == MOST == len(np.unique(colours, axis=0))
    shown = colours[Indexer(colours)(image)].astype(int)
    assert tuple(shown[150, 3]) == palette.CONTACT
    assert (shown[:150] == 255).all()
    assert np.abs(shown - image).mean() < 16.0
    few = chosen_colours([image[:150]], [palette.CONTACT])
    assert len(few) == 2, "no more colours than there are"


def test_every_pixel_has_the_nearest_colour() -> None:
    colours = np.array([[0, 0, 0], [200, 0, 0], [0, 0, 255]], np.uint8)
    image = np.array([[[90, 0, 0], [110, 0, 0], [0, 0, 140], [0, 0, 0]]], np.uint8)
    assert Indexer(colours)(image).tolist() == [[0, 1, 2, 0]]


@pytest.mark.parametrize("name", ["film.gif", "film.webp", "film.mp4"])
def test_an_error_on_the_way_leaves_nothing(
    made: Callable[..., Any], tmp_path: Path, name: str
) -> None:
    def fail(done: int, total: int) -> None:
        if done == 3:
            raise RuntimeError("from the caller")

    (tmp_path / name).write_bytes(b"an older film")
    with pytest.raises(RuntimeError, match="from the caller"):
        render(made(1), tmp_path / name, progress=fail)
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"an older film"


@pytest.mark.parametrize("kind", ["gif", "webp"])
@pytest.mark.parametrize("frames", [1, 3])
def test_stopping_leaves_the_film_so_far(
    made: Callable[..., Any], tmp_path: Path, frames: int, kind: str
) -> None:
    asked = iter([*[False] * (frames - 1), True])
    short = tmp_path / f"film.cut_short.{kind}"
    done = render(
        made(3), tmp_path / f"film.{kind}", fps=10.0, speed=1.0, width=320,
        stop=lambda: next(asked), cut_short=short,
    )  # fmt: skip
    with Image.open(short) as film:
        assert done == frames == film.n_frames
    assert [file.name for file in tmp_path.iterdir()] == [short.name]


def test_an_mp4_may_be_smaller(made: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    render(made(1), path, fps=1.0, speed=1.0, width=642)
    with av.open(str(path)) as file:
        frame = next(file.decode(video=0))
    assert (frame.width, frame.height) == (642, 362)
    shown = frame.reformat(format="rgb24", src_colorspace="ITU601").to_ndarray().astype(int)
    drawn = resized(frame_at(made(1), 0.0, fps=1.0, speed=1.0), (642, 362))
    assert np.abs(shown - drawn).mean() < 4.0


@pytest.mark.parametrize(
    ("name", "wrong", "words"),
    [
        ("film.gif", {"fps": 30.0}, facts("fps 30", "nearest is 25")),
        ("film.gif", {"fps": 60.0}, facts("1 to 50")),
        ("film.webp", {"fps": 60.0}, facts("1 to 50")),
        ("film.gif", {"width": 641}, facts("641", "even")),
        ("film.mp4", {"width": 1282}, facts("1282", "1280")),
        ("film.gif", {"speed": 0.001, "fps": 20.0}, facts("80001 frames", "--from", ".mp4")),
        ("film.png", {}, facts(".mp4, .m4v, .gif, .webp")),
    ],
)
def test_what_cannot_be_held_is_refused(
    made: Callable[..., Any], tmp_path: Path, name: str, wrong: Any, words: str
) -> None:
    with pytest.raises(PhysimError, match=words) as caught:
        render(made(1), tmp_path / name, **wrong)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_still_is_the_picture_of_its_time(made: Callable[..., Any], tmp_path: Path) -> None:
    record, path = made(3), tmp_path / "frame.png"
    still(record, path, 1.3)
    with Image.open(path) as image:
        assert np.array_equal(np.asarray(image), frame_at(record, 1.3))
    still(record, path, 4.0, width=640)
    with Image.open(path) as image:
        assert image.size == (640, 360)
    assert [file.name for file in tmp_path.iterdir()] == ["frame.png"]


@pytest.mark.parametrize(
    ("name", "time", "words"),
    [
        ("frame.png", 4.1, facts("4.1 s", "0 to 4 s")),
        ("frame.png", -0.1, facts("outside")),
        ("frame.png", float("nan"), facts("outside")),
        ("frame.mp4", 1.0, facts(".png")),
        ("absent/frame.png", 1.0, facts("no folder")),
    ],
)
def test_a_still_that_cannot_be_made(
    made: Callable[..., Any], tmp_path: Path, name: str, time: float, words: str
) -> None:
    with pytest.raises(PhysimError, match=words):
        still(made(1), tmp_path / name, time)
    assert not list(tmp_path.iterdir())
