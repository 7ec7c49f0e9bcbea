"""The overlapping of two auxiliary bodies that frees the end faces: equivalent loads and what they do.

A finite body is the sum of H, a half-space under the equivalent load ``P_h`` mirrored at the ends, and V, a vertical
slab (or half-space) under normal loads ``S`` on its faces, mirrored at the top. Symmetry removes every shear; ``P_h``
and ``S`` follow from one small dense system per wavenumber along y. The loads are analytic functions of their
wavenumbers, so every sum and integral over them is taken along a ray in the complex plane, on which oscillation
becomes decay; this is what makes the stresses right next to the ends and the top.
"""
