"""Stress of incompatible strains that do not depend on y: the residual stress of plastic flow under many passes.

In a body infinite along y with fields of (x, z), the strain along y vanishes, and the stresses in the plane (x, z) and
across it are two problems. Stress functions solve both: every stress function is in equilibrium and leaves faces free,
to rounding; the compatibility of the strains is approximate, by the least complementary energy.
"""
