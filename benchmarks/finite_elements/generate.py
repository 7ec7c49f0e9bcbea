"""Regenerate the stored references: `python -m benchmarks.finite_elements.generate stress|contact|passes|film`.

On one core `stress` takes ten to fifteen minutes, `contact` about six, `passes` about half an hour, `film` three.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.finite_elements import contact_file, film_file, passes_file, stress_file
from contactstudy.verification.problems import CONTACT_FILE, FILM_FILE, PASSES_FILE, STRESS_FILE

DATA = Path(__file__).resolve().parents[2] / "data"


def main() -> None:
    """Write a reference file."""
    parser = argparse.ArgumentParser(description="Regenerate a file of finite-element references.")
    parser.add_argument("kind", choices=("stress", "contact", "passes", "film"))
    parser.add_argument("--out", metavar="FOLDER", type=Path, default=DATA, help="default: the project's data")
    options = parser.parse_args()
    if options.kind == "stress":
        stress_file.write(options.out / STRESS_FILE)
    elif options.kind == "contact":
        contact_file.write(options.out / CONTACT_FILE)
    elif options.kind == "film":
        film_file.write(options.out / FILM_FILE)
    else:
        passes_file.write(options.out / PASSES_FILE)


if __name__ == "__main__":
    main()
