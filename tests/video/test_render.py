from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from physim.drawing import palette
from physim.drawing.video import frame_at, render
from physim.errors import PhysimError
from tests.helpers import facts, inside

rgb, Timeline = inside("physim.drawing", "rgb", "Timeline")
Painter, frame_times = inside("physim.drawing.video", "Painter", "frame_times")
playback_speed = inside("physim.drawing.video", "playback_speed")
AT_STOP = inside("physim.parts", "AT_STOP")


def decoded(path: Path) -> list[Any]:
    with av.open(str(path)) as file:
        stream = file.streams.video[0]
        assert stream.codec_context.name == "h264"
        assert (stream.width, stream.height) == (1280, 720)
        assert stream.codec_context.pix_fmt == "yuv420p"
        assert (stream.codec_context.colorspace, stream.codec_context.color_range) == (5, 1)
        return list(file.decode(video=0))


def boxes(path: Path) -> list[bytes]:
    """Names of the boxes at the top of an MP4, in order."""
    data, at, names = path.read_bytes(), 0, []
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at : at + 8])
        names.append(name)
        at += size
    return names


def test_the_file_decodes_with_the_right_size_and_number_of_frames(
    made: Callable[..., Any], tmp_path: Path
) -> None:
    record, path = made(3), tmp_path / "video.mp4"
    seen: list[tuple[int, int]] = []
    frames = render(record, path, fps=10.0, speed=2.0, progress=lambda *n: seen.append(n))
    held = 15  # 1.5 s
    assert frames == 21 + held == len(frame_times(0.0, 4.0, 10.0, 2.0))
    assert seen == [(k, 36) for k in range(1, 37)]
    pictures = decoded(path)
    assert len(pictures) == frames
    assert pictures[-1].time == pytest.approx(3.5)
    assert boxes(path).index(b"moov") < boxes(path).index(b"mdat"), "index must be at the front"
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]


def test_the_decoded_picture_is_the_drawn_one(made: Callable[..., Any], tmp_path: Path) -> None:
    record, path = made(1), tmp_path / "video.mp4"
    render(record, path, fps=1.0, speed=1.0)
    shown = decoded(path)[0].reformat(format="rgb24", src_colorspace="ITU601").to_ndarray()
    drawn = frame_at(record, 0.0, fps=1.0, speed=1.0)
    assert np.abs(shown.astype(int) - drawn).mean() < 3.0
    for colour in (palette.SAFE_AREA, palette.DANGER_AREA, palette.OUTSIDE):
        flat = (drawn == colour).all(axis=2)
        assert flat.sum() > 10_000
        assert np.abs(np.median(shown[flat], axis=0) - colour).max() <= 4


def test_the_last_picture_stays_and_shows_the_last_decisions(
    made: Callable[..., Any], changed: Callable[..., Any], tmp_path: Path
) -> None:
    record, path = made(3), tmp_path / "video.mp4"
    updates = record.updates.copy()
    updates["step"][-3:] = record.steps[-1]
    updates["mode"][-3:] = 3
    painter = Painter(Timeline(changed(record, updates=updates)), 4.0, 10.0)
    arrived = (painter.frame(4.0) == rgb(AT_STOP.colour)).all(axis=2).sum()
    before = (painter.frame(3.9) == rgb(AT_STOP.colour)).all(axis=2).sum()
    assert arrived > before + 500, "three robots have the colour of their last decision"
    frames = render(changed(record, updates=updates), path, fps=10.0, speed=4.0)
    shown = [picture.to_ndarray(format="gray").astype(int) for picture in decoded(path)]
    assert frames == len(shown) == 11 + 15
    moved = [(np.abs(a - shown[-1]) > 60).sum() for a in shown]
    assert max(moved[10:]) < 30 < 300 < min(moved[:10]), "compression changes a little"


def test_stopping_leaves_a_readable_file(made: Callable[..., Any], tmp_path: Path) -> None:
    path = tmp_path / "video.mp4"
    asked = iter([False, False, True])
    assert render(made(3), path, fps=10.0, speed=1.0, stop=lambda: next(asked)) == 3
    assert len(decoded(path)) == 3
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]


def test_an_error_on_the_way_leaves_nothing(made: Callable[..., Any], tmp_path: Path) -> None:
    def fail(done: int, total: int) -> None:
        raise RuntimeError("from the caller")

    before = tmp_path / "video.mp4"
    before.write_bytes(b"an older video")
    with pytest.raises(RuntimeError, match="from the caller"):
        render(made(1), before, progress=fail)
    assert [file.name for file in tmp_path.iterdir()] == ["video.mp4"]
    assert before.read_bytes() == b"an older video"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("video.avi", facts('"video.mp4"', '".avi"', ".mp4, .m4v")),
        ("video", r'as ""'),
        ("absent/video.mp4", facts("no folder", "absent")),
        ("folder.mp4", "this is a folder"),
        ("x" * 300 + ".mp4", facts("cannot write")),
    ],
)
def test_a_path_that_cannot_be_written_is_one_line(
    made: Callable[..., Any], tmp_path: Path, name: str, words: str
) -> None:
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(PhysimError, match=words) as caught:
        render(made(1), tmp_path / name, fps=1.0)
    assert "\n" not in str(caught.value)
    assert [file.name for file in tmp_path.iterdir()] == ["folder.mp4"]


def test_names_that_a_protocol_could_be_read_into(
    made: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert render(made(1), "pipe:1 %03d 日本.mp4", fps=1.0, speed=4.0) == 4
    assert len(decoded(tmp_path / "pipe:1 %03d 日本.mp4")) == 4


@pytest.mark.parametrize(
    "wrong", [{"fps": 0.0}, {"fps": float("nan")}, {"speed": -1.0}, {"speed": float("inf")}]
)
def test_settings_out_of_range(made: Callable[..., Any], tmp_path: Path, wrong: Any) -> None:
    with pytest.raises(PhysimError, match="allowed"):
        render(made(1), tmp_path / "video.mp4", **wrong)
    assert not list(tmp_path.iterdir())


def test_an_empty_record_is_refused(
    made: Callable[..., Any], changed: Callable[..., Any], tmp_path: Path
) -> None:
    record = made(1)
    empty = changed(record, time=record.time[:0], pose=record.pose[:0], steps=record.steps[:0])
    with pytest.raises(PhysimError, match="no sample"):
        render(empty, tmp_path / "video.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("duration", "speed"),
    [(0.0, 1), (80.0, 1), (80.1, 2), (330.0, 5), (400.0, 5), (401.0, 8), (700.0, 10), (1601.0, 40)],
)
def test_playback_speed(duration: float, speed: float) -> None:
    assert playback_speed(duration) == speed
