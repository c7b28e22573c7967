"""Videos and stills of a run, from its record alone."""

from physim.drawing.video.render import frame_at, render, still

__all__ = ["frame_at", "render", "still"]
