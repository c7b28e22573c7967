"""The version of physim, as installed."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("physim")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"
