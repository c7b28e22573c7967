"""Which files films and stills are written to."""

from __future__ import annotations

from pathlib import Path

import pytest

from physim.errors import RecordError
from tests.helpers import inside

check_still, kind_of, named = inside("physim.drawing.video", "check_still", "kind_of", "named")


@pytest.mark.parametrize("given", ["", ".", "..", "/", "a/..", "run", "run.avi"])
def test_what_names_no_film_or_still_is_refused_with_one_that_does(given: str) -> None:
    for refused, meant in ((kind_of, "run.mp4"), (check_still, "run.png")):
        with pytest.raises(RecordError, match=rf'did you mean "{meant}"'):
            refused(Path(given))


def test_a_name_keeps_its_stem() -> None:
    assert named(Path("a/b.film.avi"), ".gif") == "b.film.gif"
    assert named(Path("a/b"), ".png") == "b.png"
