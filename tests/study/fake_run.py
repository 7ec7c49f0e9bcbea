"""The command line with the stand-in solver, for tests that kill the process: ``python -m tests.study.fake_run``."""

import os
import sys

from contactstudy.cli import main
from contactstudy.study import worker
from contactstudy.study.settings import RunSettings
from tests.stand_in_solver import HELD, solve_fake, solve_held

worker.RUN = RunSettings(save_seconds=0.0)  # every case is written at once, so that a kill falls between two cases

if __name__ == "__main__":
    sys.exit(main(solver=solve_held if HELD in os.environ else solve_fake))
