"""Many runs: of worlds, seeds, settings and controllers; files on disk say which are done."""

from physim.campaigns.folder import Folder, read
from physim.campaigns.one_run import run_one
from physim.campaigns.pool import Processes
from physim.campaigns.rows import Row, columns
from physim.campaigns.spec import RunSpec, spec_of
from physim.campaigns.sweep import sweep

__all__ = [
    "Folder", "Processes", "Row", "RunSpec", "columns", "read", "run_one", "spec_of", "sweep",
]  # fmt: skip
