"""Runs in great number: how likely a contact is, which of two is better, what the worst is."""
