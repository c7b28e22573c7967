"""physim."""
