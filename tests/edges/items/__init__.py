"""One module an item; see `tests.edges`."""
