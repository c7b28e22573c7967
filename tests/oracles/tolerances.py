"""Tolerances of the tests that hold the controller against its oracles, each with its reason.

Oracle and controller work out the same numbers by different formulas. Coordinates of the scenes are
within 100 m, where one rounding is 1.4e-14 m.
"""

ROUNDING = 1e-10
"""[m, rad, m/s] Two derivations of one length, angle or speed: at most some hundred roundings at
100 m make 1e-12; a hundred times that is still far below what any rule turns on."""

SAME = 5e-13
"""[m, rad] Objectives nearer than this are equal for oracle and controller alike: half of the
project's TIE = 1e-12, so the roundings of neither (1e-14 for the short ways of a decision) can
bring the controller over TIE. Between SAME and ROUNDING, either candidate is right."""

TOUCH = 1e-9
"""[m] Shapes this near touch (the contact tolerance of the project)."""

TIME = 1e-6
"""[s] How well collision times agree, either way: shapes that close at 1e-3 m/s or more are at most
this long within TOUCH before they meet, and kernel and oracle may stop anywhere in between. Where
they close more slowly, or graze, the oracle says unsure."""
