"""New worlds: from templates, and from tracks, maps and drawings."""
