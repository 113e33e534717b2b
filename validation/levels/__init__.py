"""The levels of the validation, from closed forms to the effect of the flexible disc.

Modules in the order data passes:

===================  ============================================================
closed_forms         Level 1: the finite-element code and the half-space code against closed forms, computed anew in
                     every run
other_code_problems  Level 2: the problems, with definition, our answer computed now, and the run of the other
                     code
other_codes          Level 2: comparison with other codes, run where they are installed, else with stored
                     answers
printed_results      Level 3: the LTCA with half-space compliance against what the paper prints
coefficients         Level 4: the derived influence coefficients by laws, closed forms and the size of their mesh
positions            Level 5, position by position: each compliance model against the full finite-element solution
disc_stresses        Level 5, stress in the disc: by the LTCA, from its loads and the stress coefficients, against the
                     full solution
model_laws           Level 5, without full solutions: relations between the compliance models, and the effect of the
                     body in plane stress
flexible_disc        Level 6: effect of the flexible disc on the figures of a design, and when half-spaces are accurate
                     enough
===================  ============================================================
"""
