"""Records that were changed afterwards, and what `physim validate` says of each.

``python -m tests.forgeries`` tries them all, a line each; the default tests take some of them.
"""
