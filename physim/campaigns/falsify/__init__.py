"""The worst that can happen within stated bounds: searched for, shrunk, and told."""
