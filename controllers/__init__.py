"""Controllers shipped with physim, each rule of the paper in a module of its own.

The page "Notation" of the documentation lists symbol, name in code, unit and equation.
"""
