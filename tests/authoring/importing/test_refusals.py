"""Sources that cannot be imported: one message that says what, where and what to do."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from physim.authoring.importing import ImportSourceError, Options, import_world
from physim.errors import PhysimError, WorldError
from tests.authoring.importing.plans import SAMPLES, check_says, map_yaml, pgm
from tests.helpers import examples, facts, inside

shipped_folder = inside("physim.world.file", "shipped_folder")

HEADER = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n"
ROUND = np.linspace(0.0, 6.28, 200)
ROWS = "".join(f"{x},0,3,3\n" for x in range(0, 40, 2))


def refusal(path: Path, options: Options | None = None) -> str:
    with pytest.raises(PhysimError) as caught:
        import_world(path, options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    return message.removeprefix(str(path))


TRACKS = {
    "nan": (HEADER + "0,0,3,3\n5,nan,3,3\n", ":3: … y_m … nan"),
    "infinite": (HEADER + "0,0,3,3\n5,0,inf,3\n", ":3: … w_tr_right_m … inf"),
    "negative width": (HEADER + "0,0,3,3\n5,0,3,-1\n", ":3: … w_tr_left_m … -1 … 0"),
    "no width": (HEADER + "0,0,0,3\n5,0,3,1\n", ":2: … w_tr_right_m: 0 … greater than 0"),
    "text": (HEADER + "0,0,3,3\n5,zero,3,3\n", ':3: … y_m … "zero" … number'),
    "cut row": (HEADER + "0,0,3,3\n5,0\n", ":3: … 2 values … 4"),
    "decimal comma": ("0,5;0;3;3\n1;0;3;3\n", ":1: … comma … point"),
    "a fifth value": ("0,0,3,3\n5,0,3,3,x\n", ":2: … 5 values in 4 columns"),
    "spaces": ("0 0 3 3\n1 0 3 3\n", ":1: … spaces … commas"),
    "other columns": (
        "# s_m; x_m; y_m; psi_rad\n0;0;0;0\n",
        ":1: … w_tr_right_m … s_m, x_m, y_m, psi_rad",
    ),
    "two columns": ("0,0\n1,0\n", ":1: … not one column x_m, y_m, w_tr_right_m, w_tr_left_m"),
    "empty": ("", "begins with a number … x_m, y_m, w_tr_right_m, w_tr_left_m"),
    "one point": (HEADER + "0,0,3,3\n", "1 points … 2"),
    "far away": (HEADER + "0,0,3,3\n5e6,0,3,3\n", "5e+06 x 6 m … 50000 m … --scale"),
    "words below": (HEADER + ROWS + "the end\n", ":22: … 1 values in 4 columns"),
    "other names": (
        "x,y,width_left,width_right\n0,0,2,3\n10,0,2,3\n",
        ":1: … not one column x_m, y_m, w_tr_right_m, w_tr_left_m … x, y, width_left … "
        "rename … [m] points of the centreline",
    ),
    "one name is right": (
        "x_m,y_m,w_tr_right_m\n0,0,2\n10,0,2\n",
        "not one column w_tr_left_m … are x_m, y_m, w_tr_right_m; rename or add",
    ),
    "misspelt": (
        "x_m,y_m,w_tr_right_m,w_tr_lft_m\n0,0,2,3\n",
        "not one column w_tr_left_m … w_tr_lft_m … rename",
    ),
    "a title": ("Monza\n# x_m,y_m,w_tr_right_m,w_tr_left_m\n0,0,2,3\n", "1 points … 2"),
    "figure of eight": (
        HEADER + "".join(f"{np.sin(a) * 30},{np.sin(2 * a) * 15},2,2\n" for a in ROUND),
        "road meets itself at … overlap … noisy",
    ),
}


@pytest.mark.parametrize("name", TRACKS)
def test_tracks(tmp_path: Path, name: str) -> None:
    text, message = TRACKS[name]
    path = tmp_path / "t.csv"
    path.write_text(text)
    check_says(refusal(path), message)


def huge_png(width: int, height: int) -> bytes:
    """A PNG that says it is that large, and holds next to nothing."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def maps() -> dict[str, tuple[str, bytes | None, str]]:
    good = pgm(np.full((40, 60), 254))
    noise = np.random.default_rng(1).integers(0, 255, (40, 60), dtype=np.uint8)
    Image.fromarray(noise).save(written := io.BytesIO(), "png")
    png = written.getvalue()
    yaml = map_yaml("map.pgm", 0.05, (0, 0))
    return {
        "missing image": (yaml.replace("map.pgm", "mop.pgm"), good, ':1: … image: … "mop.pgm"'),
        "escape": (
            yaml.replace("map.pgm", "../../etc/passwd"),
            good,
            ':1: … image: … "../../etc/passwd" … outside the folder',
        ),
        "absolute": (
            yaml.replace("map.pgm", "/etc/passwd"),
            good,
            'image: … "/etc/passwd" … outside the folder',
        ),
        "no image": (
            yaml.replace("image: map.pgm\n", ""),
            good,
            ":1: … image: missing",
        ),
        "misspelt": (
            yaml.replace("resolution", "resolutoin"),
            good,
            ":2: … resolutoin: … resolution",
        ),
        "resolution": (
            yaml.replace("0.05", "0.0"),
            good,
            ":2: … resolution: … at least 1e-06 … 0.0",
        ),
        "two numbers": (yaml.replace(", 0.0]", "]"), good, ":3: … origin[2]: missing"),
        "origin": (yaml.replace("[0.0, 0.0, 0.0]", "0.0"), good, ":3: … origin: … a list … 0.0"),
        "thresholds": (
            yaml.replace("0.196", "0.9"),
            good,
            ":6: … free_thresh: … 0.9 … occupied_thresh … 0.65",
        ),
        "mode": (yaml + "mode: binary\n", good, ':7: … mode: … trinary, scale or raw … "binary"'),
        "nan": (yaml.replace("0.65", ".nan"), good, ":5:18: … occupied_thresh: … .nan"),
        "duplicate": (yaml + "negate: 1\n", good, ":7:1: … negate: … twice"),
        "empty": ("", good, ":1: … a mapping of keys"),
        "no YAML": ("image: [", good, "YAML"),
        "tag": ("image: !!python/object/apply:os.system [ls]\n", good, "tag"),
        "not an image": (yaml, b"hello", "map.pgm: … P2, P5 … PNG"),
        "cut PGM": (yaml, good[:-1], "map.pgm: … cannot be decoded … cut short"),
        "header": (yaml, b"P5\n60 forty\n255\n", "map.pgm: … cannot be decoded … forty"),
        "huge PGM": (yaml, b"P5\n100000 100000\n255\n", "10000000000 pixels … 50,000,000"),
        "huge PNG": (yaml, huge_png(100_000, 100_000), "10000000000 pixels … 50,000,000"),
        "cut PNG": (yaml, png[: len(png) // 2], "cannot be decoded … cut short"),
        "damaged PNG": (yaml, png[:60] + b"X" + png[61:], "cannot be decoded … damaged"),
        "nothing free": (yaml, pgm(np.zeros((40, 60))), "0 % of the cells are free … negate"),
    }


MAPS = maps()


@pytest.mark.parametrize("name", MAPS)
def test_maps(tmp_path: Path, name: str) -> None:
    text, image, message = MAPS[name]
    path = tmp_path / "map.yaml"
    path.write_text(text)
    if image is not None:
        (tmp_path / "map.pgm").write_bytes(image)
    with pytest.raises(PhysimError) as caught:
        import_world(path)
    check_says(str(caught.value), message)
    assert "\n" not in str(caught.value)


def test_a_link_out_of_the_folder_is_no_way_out(tmp_path: Path) -> None:
    folder = tmp_path / "maps"
    folder.mkdir()
    (tmp_path / "secret.pgm").write_bytes(pgm(np.full((40, 60), 254)))
    (folder / "map.pgm").symlink_to(tmp_path / "secret.pgm")
    (folder / "map.yaml").write_text(map_yaml("map.pgm", 0.05, (0, 0)))
    check_says(refusal(folder / "map.yaml"), "image: … outside the folder")


FILES = {
    "missing.csv": (None, "no such file"),
    "image.png": (b"\x89PNG", "image … scale … map.yaml"),
    "drawing.svgz": (b"\x1f\x8b", "compressed … unpack"),
    "latin.csv": ("gr\xfc\xdfe,1\n".encode("latin-1"), ":1: … 0xfc … UTF-8"),
    "what.txt": (b"hello", "--format track|ros-map|svg|wkt|geojson"),
}


@pytest.mark.parametrize("name", FILES)
def test_files(tmp_path: Path, name: str) -> None:
    content, message = FILES[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    check_says(refusal(tmp_path / name), message)


def test_a_world_is_no_map(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_bytes((shipped_folder() / "straight.yaml").read_bytes())
    check_says(refusal(path), ": is … a world of physim")


def test_folder_and_pipe(tmp_path: Path) -> None:
    assert ": is a folder" in refusal(tmp_path, Options(format="wkt"))


OPTIONS = {
    "start beyond": (Options(start=1e4), "--start 10000 … 248.1 m"),
    "gap beyond": (Options(gap=200.0), "--gap 200 … less than half of 248.1 m"),
    "too many": (Options(robots=200), "of 200 robots … 1.8 x 1 m … --robots"),
    "too wide": (Options(robot=(9.0, 8.0)), "robot 8 m wide … --robot"),
    "from outside": (
        Options(origin=(0.0, 0.0)),
        "--from (0.00, 0.00) … no closed area … m² about (",
    ),
    "to outside": (Options(goal=(0.0, 0.0)), "--to (0.00, 0.00) … place … x from"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options(name: str) -> None:
    options, message = OPTIONS[name]
    check_says(refusal(SAMPLES / "track.csv", options), message)


SAMPLE_OF = {
    "track": "track.csv",
    "ros-map": "office.yaml",
    "svg": "hall.svg",
    "wkt": "office.wkt",
    "geojson": "office.geojson",
}
USED_BY = {
    "start": (Options(start=5.0), "track", "track"),
    "gap": (Options(gap=3.0), "track", "track"),
    "open": (Options(open=True), "track", "track"),
    "specks": (Options(specks=4.0), "ros-map", "ros-map"),
    "boundary": (Options(boundary=("a",)), "svg", "svg"),
}


@pytest.mark.parametrize(
    ("name", "kind"),
    [(name, kind) for name, (_, only, _) in USED_BY.items() for kind in SAMPLE_OF if kind != only],
)
def test_an_option_that_a_kind_of_source_does_not_use_is_refused(name: str, kind: str) -> None:
    options, _, what = USED_BY[name]
    check_says(refusal(SAMPLES / SAMPLE_OF[kind], options), f"--{name} … {what} … {kind}")


SOURCES = {
    name: (SAMPLES / name).read_bytes() for name in ("office.wkt", "hall.svg", "office.geojson")
}
SOURCES["short.csv"] = (HEADER + ROWS).encode()


@examples(25, deep=150)
@given(data=st.data())
def test_cut_and_flipped_sources_give_a_world_or_one_message(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """Never a traceback: only PhysimError leaves the import."""
    name = data.draw(st.sampled_from(sorted(SOURCES)))
    content = bytearray(SOURCES[name])
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(0, len(content)))]
    for _ in range(data.draw(st.integers(0, 3))):
        if content:
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("broken") / name
    path.write_bytes(bytes(content))
    message = told(path, Options(scale=0.1 if name == "hall.svg" else None))
    assert message is None or (message.startswith(str(path)) and "\n" not in message)


def told(path: Path, options: Options) -> str | None:
    try:
        import_world(path, options)
    except ImportSourceError as error:
        return str(error)
    return None


@pytest.mark.parametrize(("given", "parts"), [
    ({"robots": 0}, ("robots", "at least 1", "0")),
    ({"lanes": -1}, ("lanes", "at least 1", "-1")),
    ({"format": "SVG"}, ("format", "track, ros-map, svg", '"SVG"', '"svg"')),
    ({"specks": -1.0}, ("specks", "at least 0", "-1.0")),
    ({"tolerance": float("nan")}, ("tolerance", "finite", "nan")),
    ({"boundary": "path"}, ("boundary", "list", '"path"')),
    ({"origin": (1.0,)}, ("origin[1]", "missing")),
    ({"robot": (1e-9, 1.0)}, ("robot[0]", "at least 0.001", "1e-09")),
    ({"robot": "fits"}, ("robot", "fit", '"fits"')),
    ({"scal": 1.0}, ("scal", "unknown", '"scale"')),
])  # fmt: skip
def test_options_from_python_are_looked_at_as_those_of_the_command_line(
    given: dict[str, Any], parts: tuple[str, ...]
) -> None:
    """They ended in tracebacks, or went by in silence."""
    with pytest.raises(WorldError, match=facts(*parts)):
        Options(**given)
    assert Options(robot=[1.2, 0.8]).robot == (1.2, 0.8)  # type: ignore[arg-type]


SCALES = (1e-9, 1e-5, 3e-4, 3e-3)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", ["track.csv", "office.yaml", "office.geojson"])
def test_a_forgotten_scale_is_told(name: str, scale: float) -> None:
    with pytest.raises(ImportSourceError, match=r"scale|a centreline needs at least 2"):
        import_world(SAMPLES / name, Options(scale=scale))


CROOKED = {
    "point.csv": ("0,0,3,3\n0.0003,0,3,3\n", "0.0003 m long … --scale"),
    "thin.csv": ("0,0,1e-4,1e-4\n20,0,1e-4,1e-4\n", "leaves the area"),
}  # fmt: skip


@pytest.mark.parametrize("name", CROOKED)
def test_what_makes_no_shape_is_refused(name: str, tmp_path: Path) -> None:
    text, message = CROOKED[name]
    path = tmp_path / name
    path.write_text(text)
    check_says(refusal(path, Options(scale=1.0)), message)
