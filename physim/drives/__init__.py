"""Drives that come with physim, one a file: `physim.parts.drive` is their contract."""
