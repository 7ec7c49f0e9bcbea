"""Every variable that the package returns: dimensions, unit, symbol and meaning, in one table.

The text of results, files and figures is taken from here by :mod:`contactstudy.arrays.variables`. A symbol is LaTeX
without dollar signs, as in the theory; quantities that no formula uses have none. Texts and quantities whose unit
depends on the row have an empty unit.
"""

from __future__ import annotations

from contactstudy.arrays.vocabulary.derived import (
    ANALYSIS,
    BEARING,
    DESIGN,
    FATIGUE,
    HEAT,
    PASSES,
    STUDIES,
    VERIFICATION,
    WEAR,
)
from contactstudy.arrays.vocabulary.solved import CONTACT, COORDINATES, FIELDS, MEASURES, SLICE_MODEL
from contactstudy.arrays.vocabulary.variable import AXES, SCALAR, STRESSES, Variable

__all__ = ["AXES", "COORDINATES", "RULES", "STRESSES", "VARIABLES", "Variable"]

VARIABLES = (
    CONTACT
    | SLICE_MODEL
    | FIELDS
    | MEASURES
    | ANALYSIS
    | FATIGUE
    | HEAT
    | BEARING
    | DESIGN
    | WEAR
    | PASSES
    | STUDIES
    | VERIFICATION
)
"""Every variable of the package but those that are named by a rule."""

RULES = {
    "peak_{name}": Variable(SCALAR, "{units}", r"\max {symbol}", "largest {variable}"),
    "peak_{name}_x": Variable(SCALAR, "m", "", "x of the largest {variable}"),
    "peak_{name}_y": Variable(SCALAR, "m", "", "y of the largest {variable}"),
    "peak_{name}_z": Variable(SCALAR, "m", "", "z of the largest {variable}"),
    "{name}_error": Variable(SCALAR, "{units}", "", "estimated discretisation error of the {variable}"),
    "{name}_over_a": Variable(("{name}",), "1", "{symbol}/a", "{symbol} over a", "{variable}"),
}
"""Names made from those of other variables or coordinates, whose unit, symbol and meaning go into the braces."""
