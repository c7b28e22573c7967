"""New worlds: like shipped ones, and from tracks, maps and drawings."""
