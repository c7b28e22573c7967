"""Videos and stills of a run, from its record alone."""

from physim.drawing.video.film import save_still
from physim.drawing.video.render import close_up, frame_at, render, still

__all__ = ["close_up", "frame_at", "render", "save_still", "still"]
