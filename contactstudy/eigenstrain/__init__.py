"""Stress of strains that do not depend on y and do not fit together: what plastic flow under many passes leaves.

In a body that is infinite along y and in which nothing depends on y, the strain along y vanishes, and the stresses in
the plane (x, z) and those across it are two problems. Stress functions solve both: whatever the function, the stress
from it is in equilibrium, and free faces are free, to rounding. Only how well the strains fit together is approximate,
and of all functions the one with the least complementary energy is taken.

=================  ===================================================================================================
splines.py         piecewise polynomials along one axis that vanish, with their slope, on both sides
stress_function.py stress functions of (x, z) as their products: stresses, and the equations of least energy
body.py            elements for a body with two ends, one or none, and the stresses under eigenstrains on cells
influence.py       stress in some cells per eigenstrain in the same cells
along.py           layers with eigenstrains that change along y, by their waves
=================  ===================================================================================================
"""
