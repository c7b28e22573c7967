"""A page in headless Chromium, with the network cut; all that it asks for and complains of is kept.

The browser is that of the system (Debian's package ``chromium``), driven by Playwright.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome")
DESKTOP, PHONE = (1280, 800), (390, 844)
POLLS, POLL = 400, 50
"""How often something is waited for, and how long [ms] each time"""


def executable() -> str | None:
    """The browser of this system; None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def is_needed() -> bool:
    """Whether a missing browser is a failure: in CI, and where ``.ci/run`` has found it."""
    return bool(os.environ.get("CI") or os.environ.get("PHYSIM_BROWSER"))


@contextmanager
def chromium() -> Iterator[Browser]:
    """The browser, for any number of pages."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable(), args=["--no-sandbox"])
        yield browser
        browser.close()


class Seen:
    """A page that was opened."""

    def __init__(self, browser: Browser, file: Path, **how: Any) -> None:
        """``how``: hash, size, scheme, motion, touch, offline, script to run first."""
        width, height = how.get("size", DESKTOP)
        context = browser.new_context(
            viewport={"width": width, "height": height},
            color_scheme=how.get("scheme", "light"),
            reduced_motion=how.get("motion", "no-preference"),
            has_touch=how.get("touch", False),
            offline=how.get("offline", True),
        )
        self.page: Page = context.new_page()
        self.faults: list[str] = []
        self.requests: list[str] = []
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("console", lambda one: self.faults.append(one.text))
        self.page.on("dialog", lambda one: (self.faults.append(one.message), one.dismiss()))
        self.page.on("request", lambda one: self.requests.append(one.url))
        if "script" in how:
            self.page.add_init_script(how["script"])
        self.page.goto(file.resolve().as_uri() + how.get("hash", ""))
        self.until("window.physim !== undefined || document.querySelector('#state.fault') !== null")

    def until(self, condition: str) -> None:
        """Wait until an expression holds in the page. Raises AssertionError where it never does."""
        for _ in range(POLLS):
            if self.ask(condition):
                return
            self.page.wait_for_timeout(POLL)
        raise AssertionError(f"never: {condition}; {self.faults}")

    def ask(self, expression: str) -> Any:
        """Value of an expression in the page."""
        return self.page.evaluate(expression)

    def text(self, selector: str) -> str:
        """Text of an element."""
        return self.page.inner_text(selector)

    def drawn_at(self, time: float) -> dict[str, Any]:
        """Scrub to a time [s]; what was drawn then, of each view: time, pose, lens, size."""
        self.page.eval_on_selector(
            "#scrub",
            "(box, time) => { box.step = 'any'; box.value = String(time);"
            "box.dispatchEvent(new Event('input')); }",
            time,
        )
        self.settle()
        found: dict[str, Any] = self.ask(
            "(({time, pose, lens, size}) => ({time, pose: [...pose], lens, size}))"
            "(physim.view.drawn)"
        )
        return found

    def settle(self) -> None:
        """Wait until what was asked for has been drawn."""
        self.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def outside(self) -> list[str]:
        """Requests for anything but the page itself and what it holds."""
        return [
            url
            for url in self.requests
            if not url.startswith("data:") and url.split("#")[0] != self.page.url.split("#")[0]
        ]

    def close(self) -> None:
        """Close the page and its context."""
        self.page.context.close()
