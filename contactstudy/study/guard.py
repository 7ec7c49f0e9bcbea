"""Scripts that run a study without a guard: worker processes import them, and would run the study again."""

from __future__ import annotations

import multiprocessing

UNGUARDED = (
    "A script that runs a study needs the guard `if __name__ == '__main__':` around that, because worker processes "
    "import it; or solve in one process with workers=0"
)
"""What to do where workers do not start."""


def refuse_in_a_worker() -> None:
    """End a process that imports a script as a worker, and would run the script's study; the parent says why."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)
