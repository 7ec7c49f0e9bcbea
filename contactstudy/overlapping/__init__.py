"""The overlapping of two auxiliary bodies with the end faces free of traction: equivalent loads and their fields.

A finite body is the sum of H, a half-space under the equivalent load ``P_h`` mirrored at the ends, and V, a vertical
slab (or half-space) under normal loads ``S`` on its faces, mirrored at the top. Symmetry removes every shear; ``P_h``
and ``S`` follow from one small dense system per wavenumber along y. The loads are analytic functions of their
wavenumbers, so a ray in the complex plane replaces the real axis in every sum and integral: oscillation becomes
decay, and stresses next to the ends and the top are accurate. docs/explanation/theory.md contains the equations.

Wavenumbers are axial (``k_x``) and along depth (``k_z``), in equations.py, and lateral (``k_y``), in problem.py. The
parity is 1 or -1 for a load even or odd about mid-length, 0 for a single end; `shortest` is the smallest distance of a
position or a step of the load from a corner and bounds all wavenumbers.
"""
