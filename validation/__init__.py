"""Comparison of the LTCA with closed forms, other codes, the paper and the finite-element solution.

Folders in the order data passes; each one's docstring lists its modules.

==============  ============================================================
hertz           Solutions of Hertz and others as references: lines and points, stresses below them
shipped_tables  Tables of cylinders that ship with the package, made anew
methods         Other methods to balance a drive: contact grids, the paper's iteration, its system without clearance
rows            Rows of the report: a compared figure with its limit and the reason for the limit
compare         One position in any model, and all metrics of a difference
levels          The levels of the validation, from closed forms to the effect of the flexible disc
study           The whole validation of a drive: which positions, in which order, and the rows of all six levels
seats           Figures of docs/theory/seats.md: laws of conforming seats against finite elements, Persson and Hertz
report          The page and files of a validation
manual          The verification manual: cases with reference, error bar and verdict
commands        ``cyclo validate``
==============  ============================================================
"""
