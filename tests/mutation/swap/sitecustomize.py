"""Loads one module from another text, if the environment says so: child processes do it, too."""

import os
from importlib.machinery import SourceFileLoader

if "PHYSIM_MUTATED_FILE" in os.environ:
    plain = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, name: str) -> object:
        """Compile the text instead of what stands in the file."""
        if self.path == os.environ["PHYSIM_MUTATED_FILE"]:
            return compile(os.environ["PHYSIM_MUTATED_TEXT"], self.path, "exec", dont_inherit=True)
        return plain(self, name)

    SourceFileLoader.get_code = get_code  # type: ignore[assignment, method-assign]
