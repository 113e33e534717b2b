"""One position in any model, and all metrics of a difference.

Modules in the order data passes:

========================  ============================================================
comparison                One position of a drive as any model answers it, and how two answers differ: all metrics
                          are defined here
derived_coefficients      Coefficients of the discs that a validation needs, each derived once and kept as a file of
                          its own
model_positions           The LTCA's answer to the same positions, with each compliance model, in the form of
                          `validation.compare.comparison`
disc_stresses             Stress in the disc as full finite elements and as each compliance model have it, and how
                          they differ
finite_element_positions  Full finite-element solutions of chosen positions, each kept as a file of its own as soon
                          as it is there
compared_positions        Every chosen position answered by full finite elements and by each compliance model, and
                          their differences
========================  ============================================================
"""
