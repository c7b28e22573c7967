from __future__ import annotations

import pytest

from tests.analysis.validation.runs import APART, INTO_WALL, REAR_END, lane


@pytest.fixture(scope="session")
def rear_end():
    return lane(REAR_END)


@pytest.fixture(scope="session")
def apart():
    return lane(APART, **{"robots.1.pose": "[6.0, -1.3, 0.0]"})


@pytest.fixture(scope="session")
def into_wall():
    return lane(INTO_WALL, **{"time.duration": 6.0})
