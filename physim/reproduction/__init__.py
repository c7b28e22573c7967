"""The paper again: its figures, its reported numbers and its claims in words, measured."""
