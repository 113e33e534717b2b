"""One contact between half-spaces, from influence coefficients to the stress below; modules in the order data passes.

==============  ============================================================
influence       Influence coefficients of uniformly pressed rectangles on an elastic half-space
unilateral      Frictionless unilateral contact: pressures that never pull and surfaces that never overlap
free_end        Free ends: bodies that stop where the contact stops are no half-spaces
pressure_cells  Contact of two half-spaces over a rectangular patch: grid, solution, loads and pressures
contact_kind    Kinds of contacts of a drive, and the separation of their surfaces
fitted_grid     Contact grids in steps of half-width and reach, and the pressure on the one that fits
tilted_grid     Contacts that tilt, on grids over their whole width: load and moment by approach and tilt
end_pressure    The largest pressure of a contact and its ratio to that at mid-width
subsurface      Stresses in a half-space below a contact patch: uniformly pressed rectangles summed (Love 1929)
hertz           Hertz' line contact: half-width and peak pressure by the load
round_bodies    Closed forms of round bodies in plane elasticity, references of wheel pins, rollers and races
==============  ============================================================
"""
