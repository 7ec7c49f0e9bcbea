"""The overlapping of two auxiliary bodies with the end faces free of traction: equivalent loads and their fields.

A finite body is the sum of H, a half-space under the equivalent load ``P_h`` mirrored at the ends, and V, a vertical
slab (or half-space) under normal loads ``S`` on its faces, mirrored at the top. Symmetry removes every shear; ``P_h``
and ``S`` follow from one small dense system per wavenumber along y. The loads are analytic functions of their
wavenumbers, so a ray in the complex plane replaces the real axis in every sum and integral: oscillation becomes
decay, and stresses next to the ends and the top are accurate.

=============  =======================================================================================================
word           meaning here
=============  =======================================================================================================
axial          along x; wavenumber ``k_x`` (axial.py)
lateral        along y; wavenumber ``k_y`` (lateral.py)
depth          along z; wavenumber ``k_z`` (equations.py)
parity         1 or -1 for a load even or odd about mid-length; 0 for a single end
mode, ray      axial wavenumbers: a few real ones, then nodes along a ray in the complex plane
core           coupling ``M(k_x, k_z)`` between H and V
source         face loads of a top load alone, without the coupling of H and V
panel          part of the range of a wavenumber (or of positions) with Gauss nodes; panels grow from 0
column         function of x as a right-hand side of the equation set; a load is a sum of columns times functions of y
synthesis      from the solutions for all columns back to positions along y
view           a load and positions in one set of axial modes, from end I or from end II
shortest       smallest distance of a position or a step of the load from a corner; it bounds all wavenumbers
=============  =======================================================================================================
"""
