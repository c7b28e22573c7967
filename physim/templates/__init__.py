"""Worlds to begin with: commented text that checks clean and runs, for ``physim new``."""

from physim.templates.group import fitted, lanes_of, most_robots
from physim.templates.project import new_project
from physim.templates.roads import ROADS, Road
from physim.templates.text import world_text

__all__ = ["ROADS", "Road", "fitted", "lanes_of", "most_robots", "new_project", "world_text"]
