"""Closed-form contact solutions that share nothing with the solver.

Sources, by the names used in the docstrings:

* Johnson, *Contact Mechanics* (1985): sections 3.2 (potentials of a loaded half-space), 3.3 (uniform pressure on a
  rectangle), 3.4 (Hertz pressure on a circle), 4.2 (line and elliptic contact), appendix 3;
* Love, *Phil. Trans. R. Soc. A* 228 (1929) 377: uniform pressure on a rectangle;
* Hamilton and Goodman, *J. Appl. Mech.* 33 (1966) 371; Hamilton, *Proc. IMechE* 197C (1983) 53: circular sliding
  contact;
* McEwen, *Phil. Mag.* 40 (1949) 454 and Smith and Liu, *J. Appl. Mech.* 20 (1953) 157: sliding line contact;
* Carter, *Proc. R. Soc. Lond.* A 112 (1926) 151 and Mindlin, *J. Appl. Mech.* 16 (1949) 259: stick and slip in rolling
  and shifting contact, by Johnson, sections 7.2 and 8.3;
* Blok, *Proc. IMechE General Discussion on Lubrication* 2 (1937) 222, Jaeger, *Proc. R. Soc. N.S.W.* 76 (1942) 203, and
  Carslaw and Jaeger, *Conduction of Heat in Solids* (1959): moving and resting sources of heat;
* Eshelby, *Proc. R. Soc.* A 241 (1957) 376 and Muskhelishvili, *Some Basic Problems of the Mathematical Theory of
  Elasticity*, chapter 19: eigenstrain in a half-plane;
* Bufler, *Ing.-Arch.* 27 (1959) 137 and Johnson, section 7.2: sliding line contact of unlike materials.

Axes and signs are the package's: `z` into the body, stress positive in tension, pressure positive in compression,
traction ``q = f p`` drags the body's surface along ``+y``. Stresses are returned as a dictionary with the keys of
`COMPONENTS`.
"""

from contactstudy.verification.closed_forms.circle import (
    hertz_circle,
    hertz_circle_axis,
    hertz_circle_surface,
    sliding_circle_surface,
)
from contactstudy.verification.closed_forms.components import COMPONENTS, Stress, von_mises
from contactstudy.verification.closed_forms.eigenstrain import rectangle_in_half_plane
from contactstudy.verification.closed_forms.friction import (
    carter_creepage,
    carter_force,
    carter_traction,
    mindlin_shift,
    mindlin_stick,
)
from contactstudy.verification.closed_forms.heat import (
    fast_line,
    moving_band,
    resting_hertz_circle,
    resting_square,
)
from contactstudy.verification.closed_forms.hertz import (
    EllipticContact,
    composite_modulus,
    hertz_ellipse,
    hertz_line,
    hertz_line_from_pressure,
    hertz_point,
)
from contactstudy.verification.closed_forms.line import hertz_strip
from contactstudy.verification.closed_forms.point_load import point_load
from contactstudy.verification.closed_forms.rectangle import (
    below_rectangle_corner,
    rectangle,
    rectangle_displacement,
)
from contactstudy.verification.closed_forms.sliding import SlidingLine, sliding_line

__all__ = [
    "COMPONENTS",
    "EllipticContact",
    "SlidingLine",
    "Stress",
    "below_rectangle_corner",
    "carter_creepage",
    "carter_force",
    "carter_traction",
    "composite_modulus",
    "fast_line",
    "hertz_circle",
    "hertz_circle_axis",
    "hertz_circle_surface",
    "hertz_ellipse",
    "hertz_line",
    "hertz_line_from_pressure",
    "hertz_point",
    "hertz_strip",
    "mindlin_shift",
    "mindlin_stick",
    "moving_band",
    "point_load",
    "rectangle",
    "rectangle_displacement",
    "rectangle_in_half_plane",
    "resting_hertz_circle",
    "resting_square",
    "sliding_circle_surface",
    "sliding_line",
    "von_mises",
]
