"""Importing matplotlib in two thirds of the time, for commands that draw once and end."""

from __future__ import annotations


def import_matplotlib() -> None:
    """Import matplotlib without the tables of properties in its docstrings.

    It makes them for each of its hundred classes at import, from the docstrings of all their
    methods: a tenth of the whole time of ``physim preview``, and nobody reads them there. Only for
    a process of our own: who imports physim as a library keeps matplotlib's docstrings.
    """
    from matplotlib import artist

    full = artist.kwdoc
    artist.kwdoc = _no_table  # type: ignore[assignment]
    try:
        import matplotlib.backends.backend_agg
        import matplotlib.figure  # noqa: F401
    finally:
        artist.kwdoc = full


def _no_table(_artist: object) -> str:
    return ""
