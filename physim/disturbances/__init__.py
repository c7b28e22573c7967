"""What goes wrong in the real world, each a part by a registered name, off where none is named."""
