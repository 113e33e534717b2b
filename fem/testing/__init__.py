"""Regenerates what the regression tests compare with.

Modules in the order data passes:

================  ============================================================
seated_pin        A round pin in a hardly larger bore in plane strain: the reference that laws of conforming seats are held
                  against
fixtures          Regenerates the small meshes in ``meshes/``: ``python -m fem.testing.fixtures [--out meshes]``
reference_fields  Internal fields of the small meshes in ``meshes/``, for regression: ``python -m
                  fem.testing.reference_fields``
================  ============================================================
"""
