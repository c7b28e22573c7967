"""The ground of a world: its area, its corridors, polylines, solids; numpy and shapely, no kernels.

Not for the hot path: what a run looks up at every step is in `physim.geometry`.
"""
