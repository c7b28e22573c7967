"""A pytest plugin for runs in a scratch copy: which test noticed, and from where physim came.

Hypothesis tries what it always tries, but makes no counterexample smaller: one is enough.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest
from hypothesis import Phase, settings

REPORT = "PHYSIM_SABOTAGE_REPORT"
"""Environment variable that names the file the plugin writes."""


class Notice:
    """First test that failed, and modules that are not those of the scratch copy."""

    def __init__(self) -> None:
        self.failed: str | None = None

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Take down a file that could not be read as tests."""
        if report.failed and self.failed is None:
            self.failed = report.nodeid

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Take down the first failure."""
        if report.failed and self.failed is None:
            self.failed = report.nodeid

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write what was seen."""
        seen = {
            "failed": self.failed,
            "ran": session.testscollected,
            "imported": [name for name in sys.modules if name.split(".")[0] == "physim"],
            "foreign": foreign(Path(session.config.rootpath)),
        }
        Path(os.environ[REPORT]).write_text(json.dumps(seen), encoding="utf-8")


def foreign(root: Path) -> list[str]:
    """Files of physim's modules that do not lie in the copy."""
    files = [
        Path(str(module.__file__)).resolve()
        for name, module in list(sys.modules.items())
        if name.split(".")[0] == "physim" and getattr(module, "__file__", None)
    ]
    return [str(file) for file in files if not file.is_relative_to(root.resolve())]


def pytest_configure(config: pytest.Config) -> None:
    """Hang the plugin in; the profile of tests/conftest.py is loaded by then."""
    phases = (Phase.explicit, Phase.generate)
    settings.register_profile("sabotage", parent=settings(), phases=phases)
    settings.load_profile("sabotage")
    config.pluginmanager.register(Notice())
