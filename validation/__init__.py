"""Comparison of the LTCA with closed forms, other codes, the paper and the finite-element solution.

Modules in the order data passes:

============================  ==============================================================
`comparison`                  one position in any model, and all metrics of a difference
`rows`                        a compared figure with its limit and the reason of the limit
`closed_forms`                level 1: the codes against closed forms
`other_codes`                 level 2: CalculiX and tamaas, run or stored
`printed_results`             level 3: the LTCA against the paper's printed results
`derived_coefficients`        coefficients of each case's disc, kept as files
`coefficient_rows`            level 4: the coefficients by laws and mesh size
`finite_element_positions`    full solutions, each kept as a file
`model_positions`             the LTCA's answers in the same form
`compared_positions`          every position in all models
`position_rows`               level 5: position by position
`model_laws`                  level 5: what the models owe each other
`meaning`                     level 6: what the flexible disc changes
`study`                       the plan and its execution, all levels
`headline`                    the figures to read first; ``validation.json``, ``rows.csv``
`scene`, `report`             the page, its drawing and its templates
`costs`                       time of one position, for the terminal only
`commands`                    ``cyclo validate``
============================  ==============================================================
"""
