"""Pages in a real browser: `python -m tests.browser PAGE --offline` looks at one."""
