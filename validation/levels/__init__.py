"""The levels of the validation, from closed forms to what the flexible disc changes.

Modules in the order data passes:

===================  ============================================================
closed_forms         Level 1: the finite-element code and the half-space code against closed forms, computed anew in
                     every run
other_code_problems  Level 2, what is solved: each problem, its definition, our answer computed now, and how another
                     code answers it
other_codes          Level 2: today's code against other people's, asked where they are installed, else as stored
                     with the command that did
printed_results      Level 3: the LTCA with half-space compliance against what the paper prints
coefficients         Level 4: the derived influence coefficients by laws, closed forms and the size of their mesh
positions            Level 5, position by position: each compliance model against the full finite-element solution
disc_stresses        Level 5, stress in the disc: the LTCA's, from its loads and the stress coefficients, against the
                     full solution's own
model_laws           Level 5, without full solutions: what the compliance models owe each other, and what the plane-
                     stress body changes
flexible_disc        Level 6: how much the flexible disc changes what a designer reads off, and when half-spaces are good
                     enough
===================  ============================================================
"""
