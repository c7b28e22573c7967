"""Who does the jobs: processes on this machine, or the workers of a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from physim._version import __version__
from physim.campaigns.processes import Processes, worker_count
from physim.campaigns.spec import engine
from physim.errors import PhysimError

CONNECT_SECONDS = 10
"""[s] in which a scheduler must answer"""
WORKERS_SECONDS = 30
"""[s] in which a scheduler must have a worker"""


@contextmanager
def executor(workers: int | None = None, scheduler: str | None = None) -> Iterator[Executor]:
    """Processes of this machine, or with ``scheduler`` (``tcp://HOST:PORT``) a Dask cluster.

    What is under way when the block is left is given up. Raises PhysimError where the scheduler
    cannot be reached, has no workers, or these have other versions.
    """
    if scheduler is not None:
        with _dask(scheduler) as found:
            yield found
        return
    processes = Processes(workers or worker_count())
    try:
        yield processes
    finally:
        processes.shutdown(cancel_futures=True)


@contextmanager
def _dask(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError:
        raise PhysimError(
            "--scheduler: needs the package distributed (pip install 'physim[dask]')"
        ) from None
    try:
        client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        reason = " ".join(str(error).split())[:200]
        raise PhysimError(
            f"--scheduler {address}: cannot be reached ({reason or type(error).__name__})"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS_SECONDS)
        except TimeoutError:
            raise PhysimError(
                f"--scheduler {address}: has no workers (dask worker {address} begins one)"
            ) from None
        _check_versions(address, client)
        found = client.get_executor(pure=False, retries=0)
        found.workers = max(1, sum(client.nthreads().values()))
        yield found
        found.shutdown(wait=False)


def versions() -> tuple[str, str]:
    """Versions of physim and its engine, in a worker."""
    return __version__, engine()


def _check_versions(address: str, client: Any) -> None:
    """Raise PhysimError where a worker would not do the same runs."""
    try:
        found = client.run(versions)
    except Exception as error:
        raise PhysimError(
            f"--scheduler {address}: physim cannot be used on its workers ({type(error).__name__}: "
            f"{' '.join(str(error).split())[:200]})"
        ) from None
    for worker, one in found.items():
        if tuple(one) != versions():
            raise PhysimError(
                f"--scheduler {address}: its worker {worker} has physim {one[0]}, {one[1]}; here "
                f"are physim {__version__}, {engine()}"
            )


__all__ = ["executor"]
