"""The metrics of a record by the name that the documentation gives: ``from physim.metrics …``."""

from physim.analysis.metrics import *  # noqa: F403
