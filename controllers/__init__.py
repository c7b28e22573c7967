"""Controllers shipped with physim, each rule of the paper in a module of its own.

docs/explanation/symbols.md lists symbol, name in code, unit and equation.
"""
