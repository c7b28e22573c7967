"""Write what users read anew: ``python -m tests.goldens [NAME ...]``."""

from __future__ import annotations

import sys

from tests.goldens.make import everything
from tests.goldens.values import write

if __name__ == "__main__":
    made = everything()
    for name in sys.argv[1:] or made:
        write(name, made[name]())
