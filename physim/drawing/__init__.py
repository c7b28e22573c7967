"""Pictures: the scene as all show it, previews of worlds, plots, videos and pages of records."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules={"page", "plots", "preview", "video"}
)
