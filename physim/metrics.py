"""Figures of a run, each from its record alone: `measure` gives all that have a meaning for it."""

from physim.analysis.metrics import *  # noqa: F403
