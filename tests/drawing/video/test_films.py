"""Films and stills: what programs that show them find in the files; written whole or not at all."""

from __future__ import annotations

import re
import signal
import struct
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import imageio.v3 as iio
import numpy as np
import pytest
from imageio_ffmpeg import get_ffmpeg_exe
from PIL import Image

from physim.drawing.video import frame_at, still
from physim.errors import PhysimError
from tests.drawing import palette
from tests.helpers import facts, inside

check_still, frame_times = inside("physim.drawing.video", "check_still", "frame_times")
kind_of, playback_speed = inside("physim.drawing.video", "kind_of", "playback_speed")
render, resized = inside("physim.drawing.video", "render", "resized")
VideoFile = inside("physim.drawing.video", "VideoFile")

Made = Callable[..., Any]


def decoded(path: Path) -> list[Any]:
    """Pictures (h, w, 3) of an MP4."""
    found = iio.immeta(path, plugin="FFMPEG")
    assert found["codec"] == "h264"
    assert re.match(r"yuv420p\(tv, bt470bg/bt709/bt709", found["pix_fmt"])
    return [picture.astype(int) for picture in iio.imiter(path, plugin="FFMPEG")]


def animated(path: Path) -> tuple[list[Any], list[int]]:
    """Frames (h, w, 3) of a GIF or WebP, and how long each is seen [ms]."""
    frames, lasts = [], []
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB")).astype(int))
            lasts.append(film.info["duration"])
    return frames, lasts


def boxes(path: Path) -> list[bytes]:
    """Names of the boxes at the top of an MP4, in order."""
    data, at, names = path.read_bytes(), 0, []
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at : at + 8])
        names.append(name)
        at += size
    return names


def test_an_mp4_has_all_frames_and_its_index_at_the_front(made: Made, tmp_path: Path) -> None:
    record, path = made(3), tmp_path / "video.mp4"
    seen: list[tuple[int, int]] = []
    frames = render(record, path, fps=5.0, speed=2.0, progress=lambda *n: seen.append(n))
    held = 8  # 1.5 s
    assert frames == 11 + held == len(frame_times(0.0, 4.0, 5.0, 2.0))
    assert seen == [(k, frames) for k in range(1, frames + 1)]
    pictures = decoded(path)
    assert pictures[0].shape == (720, 1280, 3)
    assert len(pictures) == frames
    assert iio.immeta(path, plugin="FFMPEG")["fps"] == 5.0
    assert boxes(path).index(b"moov") < boxes(path).index(b"mdat")
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]


@pytest.mark.parametrize("width", [642, 1280])
def test_the_pictures_of_an_mp4_are_the_drawn_ones(made: Made, tmp_path: Path, width: int) -> None:
    path = tmp_path / "video.mp4"
    render(made(1), path, fps=1.0, speed=1.0, width=width)
    for time, shown in zip((0.0, 1.0), decoded(path), strict=False):
        assert shown.shape[1] == width
        drawn = frame_at(made(1), time, fps=1.0, speed=1.0)
        small = np.asarray(resized(Image.fromarray(drawn), shown.shape[1::-1]))
        assert np.abs(shown - small).mean() < 4.0
        if width == 1280:
            for colour in (palette.SAFE_AREA, palette.DANGER_AREA, palette.OUTSIDE):
                flat = (drawn == colour).all(axis=2)
                assert flat.sum() > 10_000
                assert np.abs(np.median(shown[flat], axis=0) - colour).max() <= 4


@pytest.mark.parametrize(
    ("kind", "fps"),
    [("gif", 10.0), pytest.param("gif", 25.0, marks=pytest.mark.deep), ("webp", 15.0)],
)
def test_frames_are_seen_as_long_as_they_should(
    made: Made, tmp_path: Path, kind: str, fps: float
) -> None:
    path = tmp_path / f"film.{kind}"
    count = render(made(3), path, fps=fps, speed=4.0, width=320)
    frames, lasts = animated(path)
    assert len(frames) == 1 + round(fps), "the last picture is there once"
    assert frames[0].shape == (180, 320, 3)
    assert abs(sum(lasts) - 1000.0 * count / fps) <= 1.0
    assert max(lasts[:-1]) - min(lasts[:-1]) <= 1
    assert lasts[-1] == pytest.approx(1500.0 + lasts[0], abs=500.0 / fps + 2.0)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_a_frame_of_an_animation_is_the_drawn_one(made: Made, tmp_path: Path, kind: str) -> None:
    record, path = made(3), tmp_path / f"film.{kind}"
    render(record, path, fps=5.0, speed=1.0, width=1280, end=0.4)
    shown = animated(path)[0][0]
    drawn = frame_at(record, 0.0, fps=5.0, speed=1.0)
    assert np.abs(shown - drawn).mean() < 0.5
    for colour in (palette.SAFE_AREA, palette.DANGER_AREA, palette.OUTSIDE, palette.CONTACT):
        flat = (drawn == colour).all(axis=2)
        assert flat.sum() > 30
        assert (shown[flat] == colour).all(), "what means something has its own colour"


@pytest.mark.parametrize("kind", ["gif", "webp", "mp4"])
def test_the_same_record_gives_the_same_film(made: Made, tmp_path: Path, kind: str) -> None:
    for name in ("a", "b"):
        render(made(3), tmp_path / f"{name}.{kind}", fps=5.0, speed=4.0, width=320)
    assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()


@pytest.mark.parametrize("name", ["film.gif", "film.webp", "film.mp4"])
def test_an_error_on_the_way_leaves_nothing(made: Made, tmp_path: Path, name: str) -> None:
    def fail(done: int, total: int) -> None:
        if done == 3:
            raise RuntimeError("from the caller")

    (tmp_path / name).write_bytes(b"an older film")
    with pytest.raises(RuntimeError, match="from the caller"):
        render(made(1), tmp_path / name, progress=fail)
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"an older film"


@pytest.mark.parametrize("kind", ["gif", "webp", "mp4"])
@pytest.mark.parametrize("frames", [1, 3])
def test_stopping_leaves_the_film_so_far(
    made: Made, tmp_path: Path, frames: int, kind: str
) -> None:
    asked = iter([*[False] * (frames - 1), True])
    short = tmp_path / f"film.cut_short.{kind}"
    done = render(
        made(3), tmp_path / f"film.{kind}", fps=10.0, speed=1.0, width=320,
        stop=lambda: next(asked), cut_short=short,
    )  # fmt: skip
    if kind == "mp4":
        assert len(decoded(short)) == frames
    else:
        with Image.open(short) as film:
            assert film.n_frames == frames
    assert done == frames
    assert [file.name for file in tmp_path.iterdir()] == [short.name]


def test_a_film_may_show_a_part_of_the_run(made: Made, tmp_path: Path) -> None:
    def count(**part: float) -> int:
        return render(made(1), tmp_path / "f.mp4", fps=5.0, speed=2.0, width=320, **part)

    assert count(start=0.4, end=2.4) == count() - 5
    assert count(start=3.2) == count() - 8
    for start, end in ((4.0, 9.0), (1.0, 1.0), (-1.0, 1.0), (float("nan"), 1.0)):
        with pytest.raises(PhysimError, match="nothing to show"):
            render(made(1), tmp_path / "no.mp4", start=start, end=end)
    assert not (tmp_path / "no.mp4").exists()


@pytest.mark.parametrize(
    ("name", "wrong", "words"),
    [
        ("film.gif", {"fps": 30.0}, facts("fps 30", "nearest is 25")),
        ("film.webp", {"fps": 60.0}, facts("1 to 50")),
        ("film.gif", {"width": 641}, facts("641", "even")),
        ("film.mp4", {"width": 1282}, facts("1282", "1280")),
        ("film.gif", {"speed": 0.001, "fps": 20.0}, facts("80001 frames", "--from", ".mp4")),
        ("film.mp4", {"fps": 0.0}, "allowed"),
        ("film.mp4", {"fps": float("nan")}, "allowed"),
        ("film.mp4", {"speed": -1.0}, "allowed"),
        ("film.mp4", {"speed": float("inf")}, "allowed"),
        ("film.png", {}, facts(".mp4, .m4v, .gif, .webp")),
        ("video.avi", {}, facts('"video.mp4"', '".avi"')),
        ("video", {}, r'as ""'),
        ("absent/video.mp4", {}, facts("no folder", "absent")),
        ("folder.mp4", {}, "this is a folder"),
        ("x" * 300 + ".mp4", {"fps": 1.0}, facts("cannot write")),
    ],
)
def test_a_film_that_cannot_be_is_refused_in_one_line(
    made: Made, tmp_path: Path, name: str, wrong: Any, words: str
) -> None:
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(PhysimError, match=words) as caught:
        render(made(1), tmp_path / name, **wrong)
    assert "\n" not in str(caught.value)
    assert [file.name for file in tmp_path.iterdir()] == ["folder.mp4"]


@pytest.mark.parametrize("given", ["", "..", "/", "a/..", "run", "run.avi"])
def test_what_names_no_film_or_still_is_refused_with_one_that_does(given: str) -> None:
    for refused, meant in ((kind_of, "run.mp4"), (check_still, "run.png")):
        with pytest.raises(PhysimError, match=rf'did you mean "{meant}"'):
            refused(Path(given))


def test_names_that_a_protocol_could_be_read_into(
    made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert render(made(1), "pipe:1 %03d 日本.mp4", fps=1.0, speed=4.0) == 4
    assert len(decoded(tmp_path / "pipe:1 %03d 日本.mp4")) == 4


@pytest.mark.parametrize("encoder", ["/bin/false", "absent"])
def test_an_encoder_that_fails_is_told_in_one_line(
    made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoder: str, capfd: Any
) -> None:
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", encoder)
    with pytest.raises(PhysimError, match=r"film\.mp4: cannot write it: ") as caught:
        render(made(1), tmp_path / "film.mp4")
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_an_encoder_that_begins_as_ctrl_c_comes_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def found() -> str:  # as imageio-ffmpeg does, which asks each for its version
        subprocess.run(["sh", "-c", "kill -INT $$; exit 0"], check=True)
        return get_ffmpeg_exe()

    monkeypatch.setattr("physim.drawing.video.film.get_ffmpeg_exe", found)
    with VideoFile(tmp_path / "film.mp4", 25.0) as film:
        film.write(np.zeros((720, 1280, 4), np.uint8))
    assert len(decoded(tmp_path / "film.mp4")) == 1
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_a_film_whose_encoder_has_ended_takes_no_more_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", "/bin/false")
    frame, taken = np.zeros((720, 1280, 4), np.uint8), []

    def write_all() -> None:
        with VideoFile(tmp_path / "film.mp4", 25.0) as film:
            for k in range(2000):
                film.write(frame)
                taken.append(k)

    with pytest.raises(PhysimError, match="cannot write it"):
        write_all()
    assert len(taken) < 2000


def test_an_empty_record_is_refused(
    made: Made, changed: Callable[..., Any], tmp_path: Path
) -> None:
    record = made(1)
    empty = changed(record, time=record.time[:0], pose=record.pose[:0], steps=record.steps[:0])
    with pytest.raises(PhysimError, match="no sample"):
        render(empty, tmp_path / "video.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("duration", "speed"), [(0.0, 1), (80.0, 1), (80.1, 2), (400.0, 5), (401.0, 8), (1601.0, 40)]
)
def test_long_runs_are_played_faster(duration: float, speed: float) -> None:
    assert playback_speed(duration) == speed


def test_frames_go_from_the_start_to_the_end_and_stay_there() -> None:
    assert frame_times(0.0, 0.0, 2.0, 1.0).tolist() == [0.0] * 4
    assert frame_times(0.0, 1.0, 4.0, 1.0).tolist() == [0.0, 0.25, 0.5, 0.75] + 7 * [1.0]
    assert frame_times(0.0, 1.1, 2.0, 1.0).tolist() == [0.0, 0.5, 1.0, 1.1, 1.1, 1.1, 1.1]
    assert frame_times(2.0, 3.0, 2.0, 1.0).tolist() == [2.0, 2.5] + 4 * [3.0]
    assert (frame_times(0.0, 100.0, 25.0, 8.0) == 100.0).sum() == 1 + round(1.5 * 25.0)


def test_a_still_is_the_picture_of_its_time(made: Made, tmp_path: Path) -> None:
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
def test_a_still_that_cannot_be_is_refused(
    made: Made, tmp_path: Path, name: str, time: float, words: str
) -> None:
    with pytest.raises(PhysimError, match=words):
        still(made(1), tmp_path / name, time)
    assert not list(tmp_path.iterdir())
