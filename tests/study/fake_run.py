"""The command line with the stand-in solver, for tests that kill the process: ``python -m tests.study.fake_run``."""

import sys

from contactstudy.cli import main
from tests.study.fakes import solve_slowly

if __name__ == "__main__":
    sys.exit(main(solver=solve_slowly))
