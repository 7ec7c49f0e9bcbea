"""One random case from its seed, and its outcome."""

from __future__ import annotations

import time
import traceback
import warnings
from dataclasses import dataclass
from random import Random

from benchmarks.fuzz import motion_properties, properties
from benchmarks.fuzz.random_cases import RandomCase, draw_case
from benchmarks.fuzz.solutions import SolvedCase, ViolationError, run
from contactstudy import ContactStudyError, MagnitudeWarning


@dataclass(frozen=True)
class Outcome:
    """Outcome of a case.

    Attributes
    ----------
    kind : str
        "converged", "not converged" (with its warning), "refused" (by an error of the package) or "violation".
    message : str
        Property, error, or message.
    checked : tuple of str
        Properties that held.
    seconds : float
        Processor time of the case.
    """

    kind: str
    message: str = ""
    checked: tuple[str, ...] = ()
    seconds: float = 0.0


MAX_SECONDS = 120.0
"""Processor time above which a case is a violation."""


def outcome_of(rng: Random, *, refined: bool | None = None) -> Outcome:
    """Draw a case, solve the case and check its properties; errors become outcomes.

    `refined` decides whether cells are refined or given; None: random.
    """
    start_time = time.process_time()
    checked: list[str] = []
    now = "drawing"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", MagnitudeWarning)  # scaled cases are of any size
            random_case = draw_case(rng, refined=refined)
            now = "solve"
            kind, message = _check_properties(random_case, rng, checked)
    except ViolationError as violation:
        now = checked.pop() if checked else now
        kind, message = "violation", f"{now}: {violation}"
    except ContactStudyError as error:
        kind, message = (
            ("refused", type(error).__name__) if not checked else ("violation", f"{checked.pop()}: {error!r}")
        )
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        kind, message = "violation", f"{(checked or [now])[-1]}: {error!r} in {frame.filename}:{frame.lineno}"
    seconds = time.process_time() - start_time
    if seconds > MAX_SECONDS and kind != "violation":
        kind, message = "violation", f"{now}: {seconds:.0f} s of processor time, {kind}"
    return Outcome(kind, message, tuple(checked), seconds)


def _check_properties(random_case: RandomCase, rng: Random, checked: list[str]) -> tuple[str, str]:
    """Solve a case and record each checked property."""
    result = run(random_case)
    if not bool(result["converged"]):
        return "not converged", ""
    solution = SolvedCase(random_case, result, rng)
    always, in_turn = properties.CONSTANT_CHECKS, properties.RANDOM_CHECKS
    if solution.moves:
        always, in_turn = always + motion_properties.CONSTANT_CHECKS, motion_properties.RANDOM_CHECKS
    for holds in always:
        checked.append(holds.__name__)
        if not holds(solution):
            checked.pop()
    # The first applicable property.
    for holds in rng.sample(in_turn, len(in_turn)):
        checked.append(holds.__name__)
        if holds(solution):
            break
        checked.pop()
    return "converged", ""
