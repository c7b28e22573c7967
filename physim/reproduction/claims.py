"""The claims of the paper by figure, a row each, and every bound that a verdict uses."""

from __future__ import annotations

import math

from physim.reproduction.measures import (
    AT_TURN,
    BEHIND,
    MOST_OF_TIME,
    ROBOTS,
    SAFE_ONES,
    SNAPSHOTS,
    START,
)
from physim.reproduction.model import PAIR_TIMES, WORDS, Claim, Part, near

SAME = 0.05
"""[-] A measured figure within 5 % of the reported one is the same: the shapes and waypoints of
the paper are unknown, so nothing closer can be expected."""
ORDER = 10.0**0.5
"""[-] A figure within this factor, half a decade to either side, is of the same order."""
FOLLOWS = 0.25
"""[m] "Closely": root mean square deviation of at most a quarter of a robot's width of 1 m."""
SHARP_TURNS_ONLY = 0.5
"""[-] Deviations away from turns are at most this share of the largest one at a turn."""
SAME_SIGN = 0.9
"""[-] share of the moments in bends at which the averaged rotation has the sign of the bend; a
robot alone must have it at every turn"""
ZERO_AT_END = 0.1
"""[m] Formation errors have converged to zero when none is larger at the end."""
BOUNDED = 10.0
"""[m] Formation errors count as bounded below the range within which robots are neighbours."""
GROWTH = 0.5
"""[m] A formation error has grown when it reaches this size, a quarter of a robot's length."""
COHESIVE = 2.0
"""[-] A group stays together when its largest distance never exceeds this multiple of that at the
start."""
WIDTH = 0.05
"""[m] Corridor widths equal the reported ones within this (widths are given to 0.1 m)."""
FARTHEST = 21.5
"""[m] reported largest distance between two robots"""
SPEED = 0.005
"""[m/s] Averaged speeds may leave 0.8 to 1.3 m/s by half of the last digit of a speed of 0.01."""
IN_TIME = 1.1
"""[-] A run takes hardly longer than its longest path at the steady speed when it stays below this
multiple of that time."""
SAFE_AREA = 0.01
"""[-] share of L by which the drawn safe area may come nearer to a wall: arcs are drawn as chords,
and the library leaves out detail below a hundredth of the distance"""
FEW = 0.5
"""[-] "Low": at most this share of what deciding at every physics step would take."""
ALWAYS = 1.0
"""[-] share of the seeds that must meet what the paper says is always so"""
LOST = (
    "The paper's shapes, waypoints and thresholds are unknown, and with them its exact figure: met "
    f"is within {SAME:.0%}, partly met within a factor of {ORDER:.1f}."
)
TIMES = "all pairs {collision_time_pairs:3 s}, decisions {collision_time_decided:3 s}"

CLAIMS = (
    Claim(
        "1", "One robot follows its path closely, to the end (Fig. 1a)", "closely",
        "root mean square deviation {deviation_rms:2 m}, arrives: {finished:yes}",
        lambda run: run["finished"] > 0 and run["deviation_rms"] <= FOLLOWS,
        lambda run: run["finished"] > 0,
        f"Closely is taken as at most {FOLLOWS} m; the paper's path is unknown.",
    ),
    Claim(
        "1", "Deviations are large at sharp turns only (Fig. 1b)",
        "large whenever there are sharp turns",
        "largest at turns {deviation_at_turns:2 m}, elsewhere {deviation_elsewhere:2 m}",
        lambda run: run["deviation_elsewhere"] <= SHARP_TURNS_ONLY * run["deviation_at_turns"],
        remark=f"At a turn means within {AT_TURN:g} m of it; the first {START:g} m, on which the "
        "robot comes out of its random heading, do not count.",
    ),
    Claim(
        "1", "The averaged rotational speed is positive on left turns and negative on right turns "
        "(Fig. 1c)", "above zero left, below zero right",
        "left turns at least {rotation_left_least:3 rad/s}, right turns at most "
        "{rotation_right_largest:3 rad/s}",
        lambda run: run["rotation_left_least"] > 0.0 > run["rotation_right_largest"],
    ),
    Claim(
        "2", "Three robots move as one group (Fig. 2a, snapshots every 21 s)",
        "progress collectively as a cohesive group",
        "largest distance at the start {spread_start:1 m}, at any snapshot {spread_largest:1 m}, "
        "all arrive: {finished:yes}",
        lambda run: run["finished"] > 0
        and run["spread_largest"] <= COHESIVE * run["spread_start"],
        lambda run: run["finished"] > 0,
        f"Cohesive is taken as at most {COHESIVE:g} times the distance at the start.",
    ),
    *(
        Claim(
            figure, f"Formation errors grow in bends ({where})", reported,
            "root mean square in bends {error_in_bends:2 m}, on straights {error_on_straights:2 "
            "m}, largest error {formation_error_peak:2 m}",
            lambda run: run["error_in_bends"] > run["error_on_straights"]
            and run["formation_error_peak"] >= GROWTH,
            remark="In bends means that some robot is in one; the paper's waypoints are unknown.",
        )
        for figure, where, reported in (
            ("2", "Fig. 2b", "increase at sharp path curvatures"),
            ("7", "Fig. 7a", "become nonzero in the curved parts"),
        )
    ),
    *(
        Claim(
            figure, f"Formation errors converge to zero by the end ({where})", "0 m",
            "largest at the end {formation_error_final:2 m}",
            lambda run: run["formation_error_final"] <= ZERO_AT_END,
            remark=f"Zero is taken as at most {ZERO_AT_END:g} m.",
        )
        for figure, where in (("2", "Fig. 2b"), ("7", "Fig. 7a"))
    ),
    Claim(
        "2", "Robots leave their paths by different distances, and stay near them (Fig. 2c)",
        "distances to the paths, no figure given",
        "largest of the closest robot {deviation_peak_least:2 m}, of the farthest "
        "{deviation_peak_largest:2 m}",
        lambda run: run["deviation_peak_least"] < run["deviation_peak_largest"] <= BOUNDED,
    ),
    Claim(
        "6", "Ten robots start in the lower left corner with random headings (Fig. 6a)",
        "lower left corner, random",
        "starts reach over, of the area's width {start_right:0 %}, of its height {start_top:0 %}, "
        "headings spread over {start_headings:0 °}",
        lambda run: max(run["start_right"], run["start_top"]) <= 0.5
        and run["start_headings"] >= 180.0,
        remark="Lower left is taken as the left and lower half; the paper's start poses are "
        "unknown.",
    ),
    *(
        Claim(
            figure, f"Distances between robots are always positive ({where})", "> 0 m",
            "shortest {shortest_distance:3 m}",
            lambda run: run["shortest_distance"] > 0.0, needed=ALWAYS,
        )
        for figure, where in (("3", "Fig. 3b"), ("6", "Fig. 6c"))
    ),
    Claim(
        "3", "Shortest distance between robots (Fig. 3b)", "0.2875 m",
        "{shortest_distance:4 m}",
        *near("shortest_distance", 0.2875, SAME, ORDER), LOST,
    ),
    Claim(
        "6", "No two robots are ever more than 21.5 m apart (Fig. 6c)", "21.5 m at most",
        "farthest {farthest_distance:2 m}",
        lambda run: run["farthest_distance"] <= FARTHEST, needed=ALWAYS,
    ),
    *(
        Claim(
            figure, f"Collision times are always positive ({where})", "> 0 s", TIMES,
            lambda run: min(run["collision_time_pairs"], run["collision_time_decided"]) > 0.0,
            remark="Of all pairs under their present commands, and of the decisions, walls "
            "included.",
            needed=ALWAYS,
        )
        for figure, where in (("3", "Fig. 3c"), ("6", "Fig. 6d"))
    ),
    *(
        Claim(
            figure, f"Shortest collision time ({where})", f"{reported:g} s", TIMES,
            *near("collision_time_pairs", reported, SAME, ORDER),
            f"{LOST} Ours is judged over all pairs; a longer one is safer.",
        )
        for figure, where, reported in (("3", "Fig. 3c", 0.102), ("6", "Fig. 6d", 0.06))
    ),
    Claim(
        "6", "There are no collisions", "none; looked for in the first 5 s only",
        "contacts in the whole run: {contacts:0}, in the first 5 s: {contacts_early:0}",
        lambda run: run["contacts"] == 0,
        remark="Contacts with robots and with walls, at every physics step and between steps.",
        needed=ALWAYS,
    ),
    Claim(
        "3a", "The accessible space is parted into a safe area, at least L from every boundary, "
        "and a danger area (Fig. 3a)", "safe green, danger red",
        "safe {safe_share:1 %}, nearest to a boundary {safe_gap:3 m}, L {safe_distance:1 m}",
        lambda run: 0.0 < run["safe_share"] < 1.0
        and run["safe_gap"] >= (1.0 - SAFE_AREA) * run["safe_distance"],
        remark="L is ours; the paper's value is unknown.",
    ),
    *(
        Claim(
            "4", f"Corridor width along Robot 1's path, {place} place (Fig. 4)", f"{reported} m",
            f"{{{key}:2 m}}",
            near(key, reported, WIDTH / reported, 1.0)[0],
            remark="Shortest distance to the left plus shortest distance to the right wall, every "
            "0.1 m.",
        )
        for key, place, reported in (("width_min", "narrowest", 5.3), ("width_max", "widest", 13.4))
    ),
    Claim(
        "4", "At the narrowest place two robots pass side by side, at the widest up to four "
        "(Fig. 4)", "2 and 4",
        "narrowest: {abreast_min:0}, widest: {abreast_max:0}",
        lambda run: run["abreast_min"] == 2 and run["abreast_max"] == 4,
        lambda run: run["abreast_min"] >= 2 and run["abreast_max"] >= 4,
        "Counted with the longest robot at any heading; no one robot size gives both reported "
        "numbers by division (5.3 / 2 is less than 13.4 / 5), and the paper's shapes are unknown.",
    ),
    Claim(
        "7", "Formation errors are bounded (Fig. 7a)", "bounded, no figure given",
        "largest {formation_error_peak:2 m}",
        lambda run: GROWTH <= run["formation_error_peak"] <= BOUNDED,
        remark=f"Bounded is taken as below {BOUNDED:g} m, the range of neighbours.",
    ),
    Claim(
        "7", "Averaged rotational speeds are positive when turning left, negative when turning "
        "right (Fig. 7b)", "left positive, right negative",
        "right sign in bends: {rotation_agrees:1 %}",
        lambda run: run["rotation_agrees"] >= SAME_SIGN,
        remark="A window of 10 s reaches over the ends of short bends, where the sign may differ.",
    ),
    Claim(
        "7", "Averaged forward speeds lie between 0.8 and 1.3 m/s (Fig. 7c)", "0.8 to 1.3 m/s",
        "least {averaged_speed_min:2 m/s}, largest {averaged_speed_max:2 m/s}",
        lambda run: run["averaged_speed_min"] >= 0.8 - SPEED
        and run["averaged_speed_max"] <= 1.3 + SPEED,
        lambda run: run["averaged_speed_max"] <= 1.3 + SPEED,
        "Safe mode keeps 0.92 to 1.3 m/s; only robots that give way in danger mode fall below.",
    ),
    Claim(
        "7", "Robots falling behind drive faster than 1 m/s, those leading slower (Fig. 7c)",
        "faster than 1 m/s behind, slower in the lead",
        "of the time behind, faster: {behind_is_faster:1 %}, of the time in the lead, slower: "
        "{ahead_is_slower:1 %}",
        lambda run: min(run["behind_is_faster"], run["ahead_is_slower"]) >= SAME_SIGN,
        remark=f"Behind and in the lead mean a formation error larger than {BEHIND:g} m.",
    ),
    Claim(
        "7", "Deviations from the paths differ in magnitude and direction (Fig. 7d)",
        "different in magnitudes and direction",
        "largest of the closest robot {deviation_peak_least:2 m}, of the farthest "
        "{deviation_peak_largest:2 m}, mostly left: {deviation_left:0 robots}, mostly right: "
        "{deviation_right:0 robots}",
        lambda run: run["deviation_peak_largest"] > 2.0 * run["deviation_peak_least"]
        and min(run["deviation_left"], run["deviation_right"]) > 0,
        remark="Most of it is room kept from walls: paths lie in the danger area, targets do not.",
    ),
    Claim(
        "8", "Robots switch between safe and danger mode", "both modes",
        "{both_modes:0 of 10 robots use both}",
        lambda run: run["both_modes"] == ROBOTS,
    ),
    Claim(
        "8", "Robots 5, 8 and 10 spend more time in safe mode than in danger mode",
        "more than half",
        "least share of safe mode of the three: {safe_least_of_5_8_10:1 %}",
        lambda run: run["safe_least_of_5_8_10"] > MOST_OF_TIME,
    ),
    Claim(
        "8", "Robots 5, 8 and 10 spend more of their time in safe mode than any other robot",
        "more than the rest",
        "least of the three {safe_least_of_5_8_10:1 %}, largest of the others "
        "{safe_largest_of_others:1 %}",
        lambda run: run["safe_least_of_5_8_10"] > run["safe_largest_of_others"],
    ),
    Claim(
        "8", "The other robots spend more time in danger mode than in safe mode",
        "less than half safe",
        "{others_in_danger:0 of 7 robots}, least share of safe mode {safe_least_of_others:1 %}",
        lambda run: run["others_in_danger"] == ROBOTS - len(SAFE_ONES),
        lambda run: run["others_in_danger"] > 0,
        "The paper's paths and five thresholds are unknown; ours keep robots in safe mode longer.",
    ),
    Claim(
        WORDS, "Event-triggered updates keep communication low (messages: one for each considered "
        "robot and decision)", "low, no figure given",
        "{messages:0 messages}, of those for updates at every physics step: {messages_share:1 %}",
        lambda run: run["messages_share"] <= FEW,
        remark=f"Low is taken as at most {FEW:.0%} of the messages at every step of 0.01 s; a "
        "fixed interval of 0.2 s needs about as few.",
    ),
    Claim(
        WORDS, "Event-triggered updates keep computing low (collision-time evaluations)",
        "low, no figure given",
        "{evaluations:0 evaluations}, of those for updates at every step: {evaluations_share:1 %}",
        lambda run: run["evaluations_share"] <= FEW,
        remark="As for messages.",
    ),
    Claim(
        WORDS, "Collision times adapt the update interval (14)", "no figure given",
        "intervals shorter than the longest: {shorter_intervals:2 %}",
        lambda run: run["shorter_intervals"] > 0.0,
        remark="Intervals are beta times the shortest collision time, 0.2 s at most; where it is "
        "long, as most of the time, they are 0.2 s. One more decision falls on arrival.",
    ),
    Claim(
        WORDS, "Less conservative, shorter operation time", "no figure given",
        "time to finish {time_to_finish:1 s}, longest path at 1 m/s {time_at_steady_speed:1 s}",
        lambda run: run["time_to_finish"] <= IN_TIME * run["time_at_steady_speed"],
        lambda run: not math.isnan(run["time_to_finish"]),
        f"Short is taken as at most {IN_TIME:g} times the longest path at the steady speed; the "
        "paper gives no time and compares with no other method.",
    ),
)  # fmt: skip


def parts() -> tuple[Part, ...]:
    """Every part of the paper that reports something, in its order."""
    ten = "ten_robots"

    def part(
        figure: str, title: str, world: str, *pictures: str, bare: bool = False,
        film: bool = False, snapshots: float | None = None,
    ) -> Part:  # fmt: skip
        claims = tuple(claim for claim in CLAIMS if claim.figure == figure)
        return Part(figure, title, world, pictures, claims, bare, film, snapshots)

    return (
        part("1", "Figure 1: one robot follows its path", "single_robot", "trajectories",
             "deviation", "speeds", film=True),
        part("2", "Figure 2: three robots in formation", "three_robots", "trajectories",
             "formation", "deviation", film=True, snapshots=SNAPSHOTS),
        part("3", "Figure 3: distances and collision times of the three robots", "three_robots",
             "distances", PAIR_TIMES, "collision_times", bare=True),
        part("3a", "Figure 3a: safe and danger area", "three_robots", "trajectories",
             snapshots=SNAPSHOTS),
        part("4", "Figure 4: corridor width", ten, "width"),
        part("6", "Figure 6: ten robots", ten, "trajectories", "distances", PAIR_TIMES,
             "collision_times", bare=True, film=True),
        part("7", "Figure 7: formation errors, speeds and deviations of the ten robots", ten,
             "formation", "speeds", "deviation"),
        part("8", "Figure 8: modes of the ten robots", ten, "modes", bare=True),
        part(WORDS, "Claims in words", ten),
    )  # fmt: skip
