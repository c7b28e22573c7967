"""Parts that users add: what controllers and stages are, and how they are found by name."""
