"""Settings that cannot be, and how the rules get the rest."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from tests.helpers import inside

ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"dwell_times": [0.05, 0.04]}, "add up to 0.09"),
        ({"distance_low": 1.0}, "distance_high is 0.8, below distance_low 1"),
        ({"time_high": 0.1}, "time_high is 0.1, below time_low 1"),
        (
            {"boundary_time_high": 0.9},
            "boundary_time_high is 0.9 s; allowed: from time_low, 1 s, to",
        ),
        ({"boundary_time_high": 2.1}, "time_high, 2 s"),
        ({"horizon": 1.9}, "horizon is 1.9 s, below time_high 2 s"),
        ({"omegas": [1.0]}, "no 0"),
        ({"beta": 1.0}, "less than 1"),
        ({"look_ahaed": 1.0}, "look_ahaed"),
        ({"look_ahead": float("nan")}, "finite"),
    ],
)
def test_settings_that_cannot_be(settings: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        ModeSwitchingSettings.model_validate(settings)


@pytest.mark.parametrize(("may_reverse", "alone", "in_formation"), [
    (None, False, True), (True, False, False), (False, True, True),
])  # fmt: skip
def test_safe_mode_goes_forward_only_as_set_or_in_a_formation(
    may_reverse: bool | None, alone: bool, in_formation: bool
) -> None:
    settings = ModeSwitchingSettings(reverse_in_safe_mode=may_reverse)
    assert (settings.forward_only(False), settings.forward_only(True)) == (alone, in_formation)


def test_the_longest_interval_is_twice_the_period_unless_given() -> None:
    settings = ModeSwitchingSettings(update_period=0.3, dwell_times=[0.3])
    assert settings.rules().longest_interval == 0.6


def test_defaults_are_those_the_paper_states() -> None:
    """A period of 0.1 s, speeds -1, 0 and 1, rotational speeds to either side and none."""
    settings = ModeSwitchingSettings()
    assert settings.update_period == 0.1
    assert settings.speeds == [-1.0, 0.0, 1.0]
    assert settings.omegas == pytest.approx(np.pi / 4.0 * np.arange(-2, 3))
    assert 0.0 < settings.beta < 1.0
