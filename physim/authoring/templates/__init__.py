"""Worlds to begin with: commented text that checks clean and runs, for ``physim new``."""

from physim.authoring.templates.roads import ROADS, Road
from physim.authoring.templates.text import fitted, lanes_of, most_robots, new_project, world_text

__all__ = ["ROADS", "Road", "fitted", "lanes_of", "most_robots", "new_project", "world_text"]
