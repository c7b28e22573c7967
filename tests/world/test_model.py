from __future__ import annotations

import math
import re

import pytest
from hypothesis import given

from physim.errors import WorldError
from physim.world import World
from tests.helpers import examples, facts
from tests.world.strategies import worlds

ROBOT = {
    "name": "r1",
    "footprint": {"length": 1.8, "width": 1.0},
    "pose": [3.0, 1.0, 0.0],
    "path": [[0.0, 1.0], [30.0, 1.0]],
}
START = {"region": [[0, -3], [9, -3], [9, 3], [0, 3]]}


def values(**changes):
    base = {
        "name": "w",
        "time": {"step": 0.01, "duration": 30.0},
        "corridor": {"centreline": [[0, 0], [30, 0]], "width": 8},
        "robots": [ROBOT, {**ROBOT, "name": "r2", "pose": [6, 1, "random"]}],
    }
    return {**base, **changes}


def faults(**changes):
    with pytest.raises(WorldError) as caught:
        World(**values(**changes))
    return {fault.location: fault.message for fault in caught.value.faults}


@examples(25, deep=100)
@given(worlds())
def test_worlds_are_values(world):
    copy = world.changed()
    assert copy == world
    assert hash(copy) == hash(world)
    assert world.changed(seed=(world.seed + 1) % 1000) != world.changed(seed=world.seed % 1000)


def test_all_faults_come_at_once_in_our_words():
    found = faults(
        seed=True,
        nmae=1,
        time={"step": "0.1", "duratoin": 3},
        robots=[{**ROBOT, "pose": [1, math.nan]}, {**ROBOT, "path": 3}],
        formation={"spacing": "initail"},
        controller=5,
    )
    assert ("time", "duration") not in found
    for location, *parts in (
        (("time", "duratoin"), "unknown", '"duration"'),
        (("time", "step"), '"0.1"', "without quotes"),
        (("robots", 0, "pose", 1), "finite number", "given nan"),
        (("robots", 0, "pose", 2), "missing"),
        (("robots", 1, "path"), "{offset}"),
        (("formation", "spacing"), '"initail"', '"initial"'),
        (("nmae",), "unknown", '"name"'),
        (("seed",), "whole number", "given true"),
    ):
        assert re.search(facts(*parts), found[location])
    assert len(found) == 9


@pytest.mark.parametrize(
    ("changes", "location", "parts"),
    [
        ({"time": {"step": 1e-300, "duration": 2e-299}}, ("time", "step"), ("at least 1e-06",)),
        ({"time": {"step": 0.3, "duration": 1.0}}, ("time", "duration"), ("0.9", "1.2")),
        ({"time": {"step": 0.4, "duration": 0.2}}, ("time", "step"), ("longer", "duration")),
        ({"time": {"step": 1e-6, "duration": 1e3}}, ("time", "duration"), ("at most 100000000",)),
        ({"corridor": None}, (), ("neither", "corridor", "boundaries")),
        ({"boundaries": [[[0, 0], [1, 0]]]}, ("boundaries",), ("not both",)),
        (
            {"corridor": None, "boundaries": [[[0, 0], [1, 0]]]},
            ("reference_path",),
            ("with boundaries",),
        ),
        ({"corridor": {"centreline": [[0, 0], [3, 0]], "width": [1, 2, 3]}}, ("corridor", "width"),
         ("3 widths", "2 points")),
        ({"formation": {"spacing": [1, 2]}}, ("formation", "spacing", 0), ("is 0",)),
        ({"formation": {"neighbours": [["r1", "r1"]]}}, ("formation", "neighbours", 0),
         ("its own",)),
        ({"expect": {"min_distance": 0.5, "max_distance": 0.4}}, ("expect", "min_distance"),
         ("0.5 m", "max_distance", "0.4 m")),
        ({"robots": [{**ROBOT, "pose": None}]}, ("robots", 0, "pose"), ("start region",)),
        ({"robots": [{**ROBOT, "start": START}]}, ("robots", 0, "start"), ("beside", "pose")),
        ({"start": {**START, "heading": "alon"}}, ("start", "heading"), ('"along"',)),
        ({"start": {**START, "min_gap": -1}}, ("start", "min_gap"), ("at least 0",)),
        ({"start": {**START, "abreast": 1.5}}, ("start", "abreast"), ("whole number",)),
        ({"start": {}}, ("start", "region"), ("needed", "[m]", "corners")),
        ({"robots": [{**ROBOT, "omegas": [0, 2.0]}]}, ("robots", 0, "omegas", 1), ("beyond",)),
        ({"reference_path": [[0, 2e6], [1, 1]]}, ("reference_path", 0, 1), ("at most 1000000",)),
        ({"name": ""}, ("name",), ("empty",)),
        ({"name": "a\nb"}, ("name",), ("line breaks",)),
        ({"seed": 10**5000}, ("seed",), ("at most",)),
        ({"physics": {"elasticity": 2}}, ("physics", "elasticity"), ("at most 1",)),
        ({"expect": {"finished": 1}}, ("expect", "finished"), ("true or false",)),
        ({"robots": [{**ROBOT, "pose": [1, 2, "rndom"]}]}, ("robots", 0, "pose", 2),
         ("number", "random", '"rndom"', '"random"')),
        ({"robots": [{**ROBOT, "footprint": {"length": -1, "width": 1}}]},
         ("robots", 0, "footprint", "length"), ("greater than 0", "given -1")),
        ({"robots": [{**ROBOT, "footprint": {"lenght": 1, "width": 1}}]},
         ("robots", 0, "footprint", "lenght"), ('"length"',)),
        ({"robots": [{"cuont": 3, "footprints": [{"length": 1, "width": 1}]}]},
         ("robots", 0, "cuont"), ("count, name", '"count"')),
        ({"robots": [{**ROBOT, "cuont": 3}]}, ("robots", 0, "cuont"), ("name, footprint", "count")),
        ({"corridor": {"randm": {}}}, ("corridor", "randm"), ("centreline", '"random"')),
        ({"corridor": {"random": {"lenght": 9, "width": 5}}}, ("corridor", "random", "lenght"),
         ('"length"',)),
        ({"duration": 3}, ("duration",), ('"time.duration"',)),
        ({"range": 3}, ("range",), ('"formation.range" or "sensing.range"',)),
    ],
)  # fmt: skip
def test_each_fault_has_its_place_and_says_what_is_allowed(changes, location, parts):
    found = faults(**changes)
    assert re.search(facts(*parts), found[location])
    assert len(found) == 1


def test_worlds_are_changed_by_making_new_ones():
    world = World(**values())
    for of, key in ((world, "seed"), (world.robots[0], "pose"), (world.time, "step")):
        before = getattr(of, key)
        with pytest.raises(AttributeError, match=facts(f"{type(of).__name__}.{key}", "changed")):
            setattr(of, key, 4)
        with pytest.raises(AttributeError, match=facts(f"{type(of).__name__}.{key}", "changed")):
            delattr(of, key)
        assert getattr(of, key) == before


def test_a_mapping_for_a_group_changes_its_named_keys_alone():
    world = World(
        **values(formation={"gain": 0.05, "speed": 0.8}, time={"step": 0.02, "duration": 9.0})
    )
    assert world.changed(formation={"gain": 0.02}) == world.changed(
        formation={"gain": 0.02, "speed": 0.8}
    )
    assert world.changed(time={"duration": 5.0}).time.step == 0.02
    assert world.changed(formation=None).formation is None
    wide = world.changed(corridor={"width": 6.5})
    assert (wide.corridor.width, wide.corridor.centreline) == (6.5, world.corridor.centreline)
    with pytest.raises(WorldError, match=facts("time.duraton", "unknown key", "duration")):
        world.changed(time={"duraton": 5.0})


def test_a_road_of_the_other_kind_and_another_controller_take_nothing_over():
    robots = [{**ROBOT, "path": {"offset": 0.0}}]
    world = World(**values(robots=robots, controller={"type": "formation", "strength": 0.7}))
    drawn = world.changed(corridor={"random": {"length": 40.0, "width": 5.0}})
    assert drawn.is_road_random
    longer = drawn.changed(corridor={"random": {"length": 60.0}})
    assert longer == world.changed(corridor={"random": {"length": 60.0, "width": 5.0}})
    assert (
        drawn.changed(corridor={"centreline": [(0, 0), (9, 0)], "width": 4.0}).corridor.width == 4.0
    )
    assert world.changed(controller={"type": "formation"}).controller.settings == {}
    both = world.changed(controller={"sharpness": 2.0}).controller
    assert (both.type, both.settings) == ("formation", {"strength": 0.7, "sharpness": 2.0})


@pytest.mark.parametrize("key", ["radius", "Radius", "diameter", "circle"])
def test_circles_are_said_to_be_polygons(key):
    found = faults(robots=[{**ROBOT, "footprint": {key: 0.5}}])
    assert list(found) == [("robots", 0, "footprint", key)]  # length and width are not missed
    assert re.search(facts("circle", "polygon", "corners"), *found.values())


@pytest.mark.parametrize("key", ["obstacles", "boundaries"])
def test_one_polygon_or_line_where_a_list_of_them_belongs_is_told_once(key):
    found = faults(**{"corridor": None, key: [[5, 1], [6, 1], [6, 2]]})
    assert re.search(facts("[[[x, y], …], …]"), found[(key,)])
    assert not [place for place in found if place[:1] == (key,) and len(place) > 1]
