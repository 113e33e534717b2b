"""One position in any model, and all metrics of a difference.

Modules in the order data passes:

========================  ============================================================
comparison                One position of a drive as any model answers it, and how two answers differ: definitions of
                          all metrics
derived_coefficients      Coefficients of the discs that a validation needs, derived once and kept in files
model_positions           The LTCA's answer to the same positions, with each compliance model, in the form of
                          `validation.compare.comparison`
disc_stresses             Stress in the disc by full finite elements and by each compliance model, and the
                          differences
finite_element_positions  Full finite-element solutions of chosen positions, kept in one file for each position as
                          soon as it is solved
error_bars                Error bars of the full finite-element solutions of a case, from nested meshes at one of its
                          positions
compared_positions        Every chosen position answered by full finite elements and by each compliance model, and
                          their differences
========================  ============================================================
"""
