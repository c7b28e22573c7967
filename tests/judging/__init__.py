"""A log of poses, judged."""
