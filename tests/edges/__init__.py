"""What users did by mistake or out of malice, each as a trial through the command line.

A module of `tests.edges.items` is an item: ``NUMBER`` orders and names it, the first line of its
docstring says what holds, and every function ``try_...(shell)`` is a trial of it, in a folder of
its own. A new item is a new file there; nothing else is to be changed.
"""
