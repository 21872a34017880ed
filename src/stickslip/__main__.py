"""``python -m stickslip`` is the command ``stickslip``."""

import sys

from stickslip.show.cli import main

if __name__ == "__main__":
    sys.exit(main())
