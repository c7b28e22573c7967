"""``python -m physim``."""

import sys

from physim.cli import main

sys.exit(main())
