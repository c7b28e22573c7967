"""The simulation: one step after another, recorded or not."""
