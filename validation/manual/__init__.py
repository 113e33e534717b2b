"""The verification manual: cases with reference, error bar and verdict, one page each (``cyclo validate --manual``).

Modules in the order data passes:

============  ============================================================
case          What a case is: problem, references, model, figures with error bar and bound
error_bars    Error bars from elements, cells or positions halved in size
flat_block    Blocks with a flat top for contact problems
contact       Cases: Hertz' lines and points, NAFEMS' cylinder, flat punch, patch test, roller between flats
seats         Cases: a pin in a bore of nearly or exactly its own size
width         Cases: lines that tilt and crowned lines in slices against half-space grids
elasticity    Cases: a ring under pressure, a hole in a plate under tension
beams         Cases: pins between their ends, pins tied at their tips, crankshafts, rings
geometry      Cases: levers, gaps, backlash, errors of a pin
loads         Cases: printed results, sharing among pins and discs, balance of power, RV reducers
bearings      Cases: load zone, ratings, limits of the rating life
losses        Cases: slip and losses of wheel pins, efficiency
other_codes   Cases: tamaas and CalculiX on the same problems
solid_bodies  Cases: solid slab between flats, bar under its own weight, ring of finite length
solid_pairs   Cases: pairs of solid bodies in contact, against Hertz, images, half-space grids and CalculiX
kept          Figures of finished cases, kept until the whole manual is written
register      All cases by heading; solid ones have their own list
page          Pages and index
============  ============================================================
"""
