"""Comparison of the LTCA with closed forms, other codes, the paper and the finite-element solution."""
