"""`python3 -m tomlin plot`: the figures of the program."""

import sys

from tomlin._plots.command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
