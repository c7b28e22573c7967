"""Records that were changed afterwards, and what `physim validate` says of each."""
