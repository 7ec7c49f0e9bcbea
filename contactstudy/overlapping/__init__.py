"""The overlapping of two auxiliary bodies that frees the end faces: equivalent loads and what they do.

A finite body is the sum of H, a half-space under the equivalent load ``P_h`` mirrored at the ends, and V, a vertical
slab (or half-space) under normal loads ``S`` on its faces, mirrored at the top. Symmetry removes every shear; ``P_h``
and ``S`` follow from one small dense system per wavenumber along y. The loads are analytic functions of their
wavenumbers, so every sum and integral over them is taken along a ray in the complex plane, on which oscillation
becomes decay; this is what makes the stresses right next to the ends and the top.

=============  =======================================================================================================
word           meaning here
=============  =======================================================================================================
axial          along x; wavenumber ``k_x`` (axial.py)
lateral        along y; wavenumber ``k_y`` (lateral.py)
depth          along z; wavenumber ``k_z`` (equations.py)
parity         1 or -1 for a load even or odd about mid-length; 0 where one end is seen alone
mode, ray      axial wavenumbers that are summed one by one; those of the rest, along a ray in the complex plane
core           coupling ``M(k_x, k_z)`` between H and V
source         face loads that a top load alone needs, before H and V answer each other
panel          part of the range of a wavenumber (or of positions) with Gauss nodes; panels grow from 0
column         function of x for which the equation set is solved; a load is a sum of few columns times functions of y
synthesis      from the answers to all columns back to positions along y
view           a load and points as one set of axial modes sees them, from end I or from end II
shortest       smallest distance from a loaded corner that matters; it bounds all wavenumbers
=============  =======================================================================================================
"""
