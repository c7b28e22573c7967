"""Pages in a real browser: `python -m tests.drawing.browser PAGE --offline` looks at one."""
