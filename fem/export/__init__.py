"""Solids of parts, by gmsh's geometry kernel (Open CASCADE).

======  ============================================================
solids  STEP: a product for each body, flanks as exact splines
facets  STL: closed triangulated surfaces within a stated chord
======  ============================================================

Outlines, circles and frames come from `ltca.export`.
"""
