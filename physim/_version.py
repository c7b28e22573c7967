"""The version of physim, as installed."""

from importlib.metadata import PackageNotFoundError, version

try:
    VERSION = version("physim")
except PackageNotFoundError:  # run from a source tree that is not installed
    VERSION = "0+unknown"
