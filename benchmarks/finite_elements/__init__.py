"""Independent finite elements for bodies with free ends: the source of the stored references.

* `harmonics`: the body for one wavenumber along y, with scikit-fem;
* `superpose`: stresses under a load, the integral over the wavenumber;
* `contact`: contact of a rigid roller as a complementarity problem;
* `eigenstrain`: residual stress of eigenstrains, with the same body at wavenumber 0;
* `passes`: a line contact over an elastic-plastic half-plane, step by step, in plane strain;
* `shakedown`: Melan's bound as a cone program on equilibrium elements;
* `film`: Reynolds' equation on the compliance of the cells, by a dense Newton method;
* `reference_files`, `stress_file`, `contact_file`, `passes_file`, `film_file`, `generate`: the files in `data`, with
  the estimates of their errors.

`contactstudy.verification.problems` contains the load cases and reads the files.
"""
