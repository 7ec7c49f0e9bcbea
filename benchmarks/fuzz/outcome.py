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


def classify_outcome(rng: Random, *, refined: bool | None = None) -> Outcome:
    """Draw a case, solve the case and check its properties; errors become outcomes.

    `refined` decides whether cells are refined or given; None: random.
    """
    start_time = time.process_time()
    checked: list[str] = []
    step = "drawing"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", MagnitudeWarning)  # random cases have unusual magnitudes
            random_case = draw_case(rng, refined=refined)
            step = "solve"
            kind, message = _check_properties(random_case, rng, checked)
    except ViolationError as violation:
        step = checked.pop() if checked else step
        kind, message = "violation", f"{step}: {violation}"
    except ContactStudyError as error:
        kind, message = (
            ("refused", type(error).__name__) if not checked else ("violation", f"{checked.pop()}: {error!r}")
        )
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        kind, message = "violation", f"{(checked or [step])[-1]}: {error!r} in {frame.filename}:{frame.lineno}"
    seconds = time.process_time() - start_time
    if seconds > MAX_SECONDS and kind != "violation":
        kind, message = "violation", f"{step}: {seconds:.0f} s of processor time, {kind}"
    return Outcome(kind, message, tuple(checked), seconds)


def _check_properties(random_case: RandomCase, rng: Random, checked: list[str]) -> tuple[str, str]:
    """Solve a case and record each checked property."""
    result = run(random_case)
    if not bool(result["converged"]):
        return "not converged", ""
    solution = SolvedCase(random_case, result, rng)
    constant_checks, random_checks = properties.CONSTANT_CHECKS, properties.RANDOM_CHECKS
    if solution.moves:
        constant_checks, random_checks = (
            constant_checks + motion_properties.CONSTANT_CHECKS,
            motion_properties.RANDOM_CHECKS,
        )
    for check_property in constant_checks:
        checked.append(check_property.__name__)
        if not check_property(solution):
            checked.pop()
    # One random property that applies to the case.
    for check_property in rng.sample(random_checks, len(random_checks)):
        checked.append(check_property.__name__)
        if check_property(solution):
            break
        checked.pop()
    return "converged", ""
