"""The command line with the stand-in solver, for tests that kill the process: ``python -m tests.study.fake_run``."""

import sys

from contactstudy.cli import main
from tests.stand_in_solver import solve_held

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], solver=solve_held))
