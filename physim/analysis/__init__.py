"""What a record says: figures, a summary, a validation, and the crash test of the engine."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules={"crashtest", "metrics", "summary", "validation"}
)
