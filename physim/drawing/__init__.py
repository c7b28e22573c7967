"""Pictures: the scene as all of them show it, previews of worlds, plots and videos of records."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules={"plots", "preview", "video"}
)
