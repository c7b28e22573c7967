"""Campaigns: many runs of worlds, and what they say together."""
