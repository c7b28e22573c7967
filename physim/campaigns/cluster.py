"""Jobs for the workers of a Dask cluster, to which modules of one's own are uploaded."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
import re
import tempfile
import threading
import zipfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from physim._version import __version__
from physim.campaigns.pool import Job, Processes, Workers, worker_count
from physim.campaigns.sources import Source, is_installed, source_hash
from physim.campaigns.spec import engine
from physim.errors import MissingExtraError, PhysimError

CONNECT_SECONDS = 5
"""[s] in which a scheduler must answer"""
WORKERS_SECONDS = 30
"""[s] in which a scheduler must have a worker"""
ADDRESS = re.compile(r"(?:(?:tcp|tls|ws|wss)://)?(?:\[[0-9A-Fa-f:.%\w]+\]|[^\s:/\[\]]+):(\d{1,5})")
LOGGERS = ("asyncio", "distributed", "tornado.application")
"""of Dask and its loop, which tell a cluster that went, or is none, in tracebacks"""


@contextmanager
def executor(workers: int | None = None, scheduler: str | None = None) -> Iterator[Workers]:
    """Processes of this machine, or with ``scheduler`` (``tcp://HOST:PORT``) a Dask cluster.

    What is under way when the block is left is given up. Raises PhysimError where the scheduler
    cannot be reached, has no workers, or these have other versions.
    """
    if scheduler is not None:
        with _silent(), _client(scheduler) as client:
            found = Cluster(client)
            yield found
            found.inner.shutdown(wait=False)
        return
    processes = Processes(workers or worker_count())
    try:
        yield processes
    finally:
        processes.shutdown(cancel_futures=True)


class Cluster(Workers):
    """The workers of a cluster; each does a job in a process of its own."""

    here = False

    def __init__(self, client: Any) -> None:
        self.client = client
        self.inner = client.get_executor(pure=False, retries=0)
        self.workers = max(1, sum(client.nthreads().values()))
        self.archive = ""

    def carry(self, sources: Sequence[Source]) -> None:
        """Upload modules that came with neither physim nor an installed package."""
        mine = {one.module: one for one in sources if one.module and not is_installed(one.file)}
        if not mine:
            return
        self.archive = f"physim-{source_hash(tuple(mine.values()))}.zip"
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, self.archive)
            with zipfile.ZipFile(path, "w") as file:
                for name, one in mine.items():
                    end = "/__init__.py" if one.package else ".py"
                    file.writestr(name.replace(".", "/") + end, one.text)
            self.client.upload_file(path, load=False)

    def begin(self, job: Job) -> Future[Any]:
        """Have a job done."""
        found: Future[Any] = self.inner.submit(_there, job, self.archive)
        return found


def _there(job: Job, archive: str) -> Any:
    """Do a job in a process of the cluster's worker that this is called in."""
    from distributed import get_worker

    place = os.path.join(get_worker().local_directory, archive) if archive else ""
    child = _child(os.getpid(), threading.get_ident())
    return child.begin(replace(job, archive=place)).result()


@functools.cache
def _child(process: int, thread: int) -> Processes:
    """The process of one thread of a worker, which a fork has not; it stays for the next job."""
    return Processes(1)


@contextmanager
def _silent() -> Iterator[None]:
    """Let `LOGGERS` say nothing."""
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)


@contextmanager
def _client(address: str) -> Iterator[Any]:
    """A client of a scheduler that has workers of our versions. Raises PhysimError."""
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError("--scheduler", "dask") from None
    found = ADDRESS.fullmatch(address)
    if found is None or not 0 < int(found[1]) < 65536:
        raise PhysimError(
            f"--scheduler {address[:60]!r}: must be HOST:PORT or tcp://HOST:PORT, as "
            "tcp://10.0.0.1:8786"
        )
    try:
        # A `Client` may wait for ever. In a thread: a notebook has its own loop, which runs.
        with ThreadPoolExecutor(1) as aside:
            kind = aside.submit(asyncio.run, _kind(address)).result()
        if kind != "Scheduler":
            raise OSError(f"it is a {kind}")
        client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise PhysimError(
            f"--scheduler {address}: no scheduler of Dask answers in {CONNECT_SECONDS} s ({reason})"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS_SECONDS)
        except TimeoutError:
            raise PhysimError(
                f"--scheduler {address}: has no workers (dask worker {address} begins one)"
            ) from None
        try:
            there = client.run(versions)
        except Exception as error:
            raise PhysimError(
                f"--scheduler {address}: physim cannot be used on its workers "
                f"({type(error).__name__}: {' '.join(str(error).split())[:200]})"
            ) from None
        for worker, one in there.items():
            if tuple(one) != versions():
                raise PhysimError(
                    f"--scheduler {address}: its worker {worker} has physim {one[0]}, {one[1]}; "
                    f"here are physim {__version__}, {engine()}"
                )
        yield client


async def _kind(address: str) -> str:
    """What of Dask answers: ``Scheduler``, ``Worker``, ``Nanny``."""
    from distributed.core import rpc

    async with asyncio.timeout(CONNECT_SECONDS), rpc(address, timeout=CONNECT_SECONDS) as peer:
        return str((await peer.identity())["type"])


def versions() -> tuple[str, str]:
    """Versions of physim and its engine, in a worker."""
    return __version__, engine()
