"""Plastic flow under many passes of a contact: residual stress, plastic strain, profile of the surface.

After many passes the residual state does not depend on y: it is a field over the cross-section (x, z).
"""

from contactstudy.plasticity.eigenstrains import STRAINS, eigenstrain_stress
from contactstudy.plasticity.passes import ElasticPlastic, residual_stress

__all__ = ["STRAINS", "ElasticPlastic", "eigenstrain_stress", "residual_stress"]
