"""A world for the formation alone, and its linear theory: four robots on a straight road.

The robots have errors at the start. Their lanes lie so far apart that no robot comes near another
or a wall, so they keep in safe mode and (7) alone sets their speeds; the limits of these are so
wide that they do not bind. For ideal motion (8) on a straight road, (7) makes the errors e follow
the linear law de/dt = -alpha L e, L the Laplacian of the graph of neighbours.
"""

from __future__ import annotations

import json

import numpy as np

from physim.analysis.metrics import column_over_time, desired_leads
from physim.geometry.shapes import FloatArray
from physim.record import Record

SETTLED = 4.0
"""[s] by then every robot has turned onto its lane, whatever its heading was"""
LANES = (6.0, 2.0, -2.0, -6.0)
"""[m] lane of each robot, left of the middle positive"""
LEADS = (0.0, -3.0, -1.0, -4.0)
"""[m] desired lead of each robot over the first"""
FIRST = 15.0
"""[m] place of the first robot along the road, but for its error"""
LARGEST_ERROR = 1.5
"""[m] errors at the start are drawn from minus to plus this"""
RING = (("r1", "r2"), ("r2", "r4"), ("r4", "r3"), ("r3", "r1"))
"""pairs of neighbours of the graph in which each has two"""


def world_text(
    seed: int,
    *,
    name: str,
    gain: float,
    neighbours: str = "all",
    heading: str = "0.0",
    step: float = 0.01,
    period: float = 0.1,
    seconds: float = 60.0,
) -> str:
    """World file: four robots whose errors at the start depend on the seed.

    ``neighbours`` is "all" or "ring"; ``heading`` a number [rad] or the word random.
    """
    errors = np.random.default_rng(seed).uniform(-LARGEST_ERROR, LARGEST_ERROR, len(LEADS))
    graph = "all" if neighbours == "all" else json.dumps(RING)
    robots = "\n".join(
        f"  - name: r{i + 1}\n"
        "    footprint: {length: 1.6, width: 1.0}\n"
        f"    pose: [{FIRST + lead + error:.6f}, {lane}, {heading}]\n"
        f"    path: {{offset: {lane}}}\n"
        "    limits: {v: 2.0}"
        for i, (lead, lane, error) in enumerate(zip(LEADS, LANES, errors, strict=True))
    )
    return (
        f"name: {name}\nseed: {seed}\n"
        f"time: {{step: {step}, duration: {seconds}}}\n"
        f"corridor: {{centreline: [[0.0, 0.0], [{seconds + 60.0}, 0.0]], width: 20.0}}\n"
        f"robots:\n{robots}\n"
        f"formation: {{gain: {gain}, limits: [0.1, 1.9], spacing: {list(LEADS)}, "
        f"neighbours: {graph}}}\n"
        f"controller: {{update_period: {period}, dwell_times: [{period}], "
        f"longest_interval: {period}}}\n"
    )


def neighbour_matrix(record: Record) -> FloatArray:
    """(N, N) 1 where j is in N_i, of a world that lists its neighbours or takes all."""
    given = record.world_settings["formation"]["neighbours"]
    if given == "all":
        return np.ones((record.robots, record.robots)) - np.eye(record.robots)
    listed = np.zeros((record.robots, record.robots))
    for a, b in given:
        i, j = record.names.index(a), record.names.index(b)
        listed[i, j] = listed[j, i] = 1.0
    return listed


def settings_and_stations(
    record: Record,
) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Gain alpha [1/s], matrix of neighbours, decision times (K,) [s], relative stations (K, N)."""
    time, station = column_over_time(record, "reference_station")
    gain = float(record.world_settings["formation"]["gain"])
    return gain, neighbour_matrix(record), time, relative_stations(record, station)


def relative_stations(record: Record, station: FloatArray) -> FloatArray:
    """Stations (K, N) less the desired leads (N,): equal where the formation is perfect."""
    leads = desired_leads(record)
    return np.asarray(station - (0.0 if leads is None else leads))


def linear_course(
    start: FloatArray, gain: float, matrix: FloatArray, time: FloatArray
) -> FloatArray:
    """Errors (K, N) by the linear theory, from those at the start (N,)."""
    rates, modes = np.linalg.eigh(np.diag(matrix.sum(axis=1)) - matrix)
    return np.asarray((np.exp(-gain * np.outer(time, rates)) * (modes.T @ start)) @ modes.T)


def formation_sums(place: FloatArray, matrix: FloatArray) -> FloatArray:
    """S_i (K, N): the inner sums of (10), positive for a robot that is behind."""
    return np.asarray(place @ matrix - place * matrix.sum(axis=1))


def energies(place: FloatArray, matrix: FloatArray) -> FloatArray:
    """W (K,) [m^2] by (9)."""
    square = np.square(place[:, None, :] - place[:, :, None])
    return np.asarray(0.5 * np.einsum("ij,kij->k", matrix, square))
