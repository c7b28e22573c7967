"""The papers that are reproduced: what of them is run, and how their pages are to be read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from physim.reproduction.claims import parts
from physim.reproduction.model import Part
from physim.reproduction.studies import studies
from physim.reproduction.studies.polytope_vo import CORRIDOR, EIGHT, RANDOM, TURN
from physim.reproduction.study import Study


@dataclass(frozen=True)
class Paper:
    """One of them, named by its method."""

    name: str
    title: str
    """of the page"""
    about: tuple[str, ...]
    """paragraphs; ``{last}`` is the last seed"""
    parts: Callable[[], tuple[Part, ...]]
    studies: Callable[[], tuple[Study, ...]]


FIRST = Paper(
    "mode_switching",
    "The paper, reproduced",
    (
        "The paper aims at path following, formation control and collision avoidance that let "
        "several robots move together through confined space, decentralised and cooperative; its "
        "funding note is NSFC 62203133. Only its text, with the numbers of equations and figures, "
        "is available to us; its title, its authors and its printed formulas are not, and the "
        "formulas are restored from the text.",
        "The paper's waypoints, robot shapes and thresholds are unknown; worlds, footprints "
        "and settings are ours, tuned so that the reported figures come out in the same range. A "
        "measured figure is that of one run, the one in the pictures; beside it stand the median "
        "and, in parentheses, the range over other random headings (seeds 0 to {last})"
        " and the number of these runs that meet the claim. A claim is met when the run in the "
        "pictures and nine tenths of the others meet it (all of them, where the paper says always "
        "or never), partly met when only one of the two does or a weaker form of it holds. Claims "
        "about avoidance are also tested on the same runs without it; one that holds there, too, "
        "is marked as such: it is no evidence for avoidance.",
        "Two of our rules depart from the paper's: in a formation the speed pair of (5) is a "
        "choice of omega alone, as (7) gives the forward speed; and in (11) boundaries count "
        "within the sensing range only, so that a robot on its way into one beyond reports no "
        "collision time. The modules of the controller list these and smaller departures.",
    ),
    parts,
    studies,
)
SECOND = Paper(
    "polytope_vo",
    "Polytope velocity obstacles, reproduced",
    (
        "The paper is Huang, Zeng, Chi, Sreenath, Liu and Su: Velocity obstacle for polytopic "
        "collision avoidance for distributed multi-robot systems (RA-L 8, 2023). Its tables are "
        "not available to us; its published code is. What is reported here is what is stored with "
        "that code, or what a run of it gives, and each claim says which.",
        "The code moves robots by kinematics in steps of 0.1 s; robots that arrived, or touched "
        "something, stand and stay in the way. Here bodies meet by physics in steps of 0.01 s and "
        "decide every 0.1 s; a contact makes a trial a collision. As there, robots arrive within "
        "0.3 m of their goals, and a trial ends after 30 s. The worlds are those of the code; "
        "walls, which every world here must have, stand so far away that they do not count. Seed "
        "0 is as published; other seeds move each start by up to 1 mm, as one course of a few "
        "robots that avoid each other tells little. A claim about such a course is "
        "met when seed 0 takes as many steps, and as long a way, within 5 %, and 90 % of the seeds "
        "arrive; partly met when only one of the two holds, or the reported number lies among "
        "those of the seeds. Brackets hold 95 % intervals.",
    ),
    lambda: (),
    lambda: (EIGHT, CORRIDOR, TURN, RANDOM),
)


def papers() -> dict[str, Paper]:
    """All papers by name, the one that physim is about first."""
    return {one.name: one for one in (FIRST, SECOND)}
