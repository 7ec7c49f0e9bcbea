"""What many passes of a contact leave in a body: residual stress, plastic strain, the profile of the top.

After many passes nothing that is left depends on y, so the residual state is a field over the cross-section (x, z).

==============  ======================================================================================================
plastic.py      elastic-plastic materials
cells.py        cells of the cross-section around the positions of a stress field
residual.py     residual stress of any plastic strain over the cross-section
tensors.py      tensors as arrays
passage.py      plastic flow during a pass, at all places along the way at once
rolled_in.py    passes of a stress field over an elastic-plastic body
==============  ======================================================================================================
"""

from contactstudy.arrays.variables import STRESSES
from contactstudy.near_names import suggest
from contactstudy.passes.plastic import ElasticPlastic
from contactstudy.passes.residual import residual_stress
from contactstudy.passes.rolled_in import STRAINS, rolled_in

__all__ = ["STRAINS", "STRESSES", "ElasticPlastic", "residual_stress", "rolled_in"]

suggest(__name__, __all__)
