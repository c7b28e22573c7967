"""Worlds of every kind that the model allows, valid by construction."""

from __future__ import annotations

import math

from hypothesis import strategies as st

from physim.world import (
    Arrival,
    Box,
    Choice,
    ControllerChoice,
    Corridor,
    Expectation,
    Formation,
    Limits,
    Offset,
    Physics,
    Robot,
    RobotGroup,
    Sensing,
    Start,
    Time,
    World,
)
from tests.helpers import inside

WALL_NAMES = inside("physim.world", "WALL_NAMES")

coordinates = st.floats(-1e6, 1e6)
lengths = st.floats(1e-3, 100.0)
points = st.tuples(coordinates, coordinates)
labels = (
    st.text(
        st.characters(exclude_categories=["Cs", "Cc"]).filter(str.isprintable),
        min_size=1,
        max_size=12,
    )
    .map(str.strip)
    .filter(lambda name: name and not WALL_NAMES.fullmatch(name))
)
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=30)
settings = st.dictionaries(
    labels.filter(lambda key: key not in ("type", "<<")),
    st.recursive(
        st.booleans() | st.integers(-(10**17), 10**17) | st.floats(-1e300, 1e300) | texts,
        lambda inner: st.lists(inner, max_size=3).map(tuple),
        max_leaves=5,
    ),
    max_size=3,
)


choices = st.lists(
    st.builds(Choice, type=st.sampled_from(["noise", "odd: one"]), settings=settings), max_size=2
)


def _apart(line):
    return all(math.dist(a, b) > 1e-6 for a, b in zip(line, line[1:], strict=False))


polylines = st.lists(points, min_size=2, max_size=6).map(tuple).filter(_apart)
polygons = st.lists(points, min_size=3, max_size=6).map(tuple).filter(lambda p: p[0] != p[-1])


starts = st.builds(
    Start,
    region=polygons,
    heading=st.floats(-1000, 1000) | st.sampled_from(["random", "along"]),
    min_gap=st.floats(0, 100),
    abreast=st.none() | st.integers(1, 9),
) | st.builds(Start, region=polygons, abreast=st.integers(1, 9), spread=st.floats(0.0, 1.0))


paths = polylines | st.builds(Offset, offset=coordinates)
footprints = st.builds(Box, length=lengths, width=lengths) | polygons


@st.composite
def robots(draw, name, shared):
    pose = st.tuples(coordinates, coordinates, st.floats(-1000, 1000) | st.just("random"))
    nowhere = [st.just((None, None))] if shared else []
    where = draw(
        st.one_of(st.tuples(pose, st.none()), st.tuples(st.none(), starts), *nowhere),
    )
    return Robot(
        name=name,
        footprint=draw(footprints),
        pose=where[0],
        start=where[1],
        path=draw(paths),
        limits=Limits(v=draw(st.floats(0.1, 100.0)), omega=draw(st.floats(0.1, 100.0))),
        mass=draw(st.none() | lengths),
        speeds=draw(st.none() | st.just((-0.1, 0.0, 0.1))),
        omegas=draw(st.none() | st.just((0.0,))),
    )


@st.composite
def groups(draw, shared):
    """Robots in one entry; their names begin with what no other name does."""
    count = draw(st.integers(1, 3))
    one_footprint, one_path = draw(st.booleans()), draw(st.booleans())
    return RobotGroup(
        count=count,
        name=draw(st.sampled_from(["\u2603{number}", "\u2603 {number} of {number}"])),
        footprint=draw(footprints) if one_footprint else None,
        footprints=None if one_footprint else draw(st.lists(footprints, min_size=1, max_size=3)),
        start=draw(starts if not shared else st.none() | starts),
        path=draw(paths) if one_path else None,
        paths=None if one_path else draw(st.lists(paths, min_size=1, max_size=3)),
        limits=Limits(v=draw(st.floats(0.1, 100.0)), omega=draw(st.floats(0.1, 100.0))),
        mass=draw(st.none() | lengths),
        speeds=draw(st.none() | st.just((-0.1, 0.0, 0.1))),
        omegas=draw(st.none() | st.just((0.0,))),
    )


@st.composite
def worlds(draw):
    names = draw(st.lists(labels, min_size=1, max_size=3, unique=True))
    pairs = [(a, b) for i, a in enumerate(names) for b in names[:i]]
    step = draw(st.sampled_from([0.01, 0.05, 1e-5, 0.1]))
    has_corridor = draw(st.booleans())
    shared = draw(st.none() | starts)
    entries = [draw(robots(name, shared is not None)) for name in names]
    group = draw(st.none() | groups(shared is not None))
    if group is not None:
        entries.insert(draw(st.integers(0, len(entries))), group)
    count = len(names) + (group.count if group is not None else 0)
    leads = (0.0, *draw(st.tuples(*[coordinates for _ in range(count - 1)])))
    formation = Formation(
        gain=draw(st.floats(0, 10)),
        limits=tuple(sorted((draw(st.floats(0, 10)), draw(st.floats(0.1, 10))))),
        spacing=draw(st.just("initial") | st.just(leads)),
        range=draw(lengths),
        neighbours=draw(st.sampled_from(["range", "all", tuple(pairs)])),
    )
    corridor = st.builds(Corridor, centreline=polylines, width=lengths, end_margin=lengths)
    return World(
        name=draw(labels),
        description=draw(texts),
        seed=draw(st.integers(0, 10**15)),
        time=Time(
            step=step,
            duration=draw(st.integers(1, 1000)) * step,
            record_every=draw(st.integers(1, 9)),
        ),
        corridor=draw(corridor) if has_corridor else None,
        boundaries=None if has_corridor else draw(st.lists(polylines, min_size=1, max_size=3)),
        reference_path=draw(st.none() | polylines) if has_corridor else draw(polylines),
        start=shared,
        robots=entries,
        formation=draw(st.none() | st.just(formation)),
        controller=ControllerChoice(
            type=draw(st.sampled_from(["mode_switching", "odd: one"])), settings=draw(settings)
        ),
        sensing=Sensing(range=draw(st.none() | lengths), stages=draw(choices)),
        filters=draw(choices),
        disturbances=draw(choices),
        arrival=Arrival(tolerance=draw(st.floats(0, 10))),
        obstacles=draw(st.lists(polygons, max_size=2)),
        expect=draw(st.none() | st.builds(Expectation, contacts=st.integers(0, 5))),
        physics=Physics(friction=draw(st.floats(0, 1))),
    )
