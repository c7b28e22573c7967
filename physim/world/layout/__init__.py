"""What a world means: every length resolved, starts placed by the seed, shapes as arrays."""
