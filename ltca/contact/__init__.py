"""One contact between half-spaces: from influence coefficients to the pressure over a patch and the stress below it.

Modules in the order data passes:

==============  ============================================================
influence       Influence coefficients of uniformly pressed rectangles on an elastic half-space
unilateral      Frictionless unilateral contact: pressures that never pull and surfaces that never overlap
pressure_cells  Contact of two half-spaces over a rectangular patch: grid, solution, loads and pressures
length_profile  Profiles of rollers and pins along their length: what crowning and relief take away from the cylinder
generator       Generator of a roller or pin as the drive defines it: crown, logarithmic relief and end relief added
                up
grid_ladder     Ladder of the contact grids: their shapes, and which of them a contact is solved on
tracked_grid    One contact on its own grid, solved again and again while the bodies move
end_pressure    The largest pressure of a contact and how much it exceeds the one at mid-width
free_end        Free ends: bodies that stop where the contact stops are no half-spaces
subsurface      Stresses in a half-space below a contact patch: uniformly pressed rectangles summed (Love 1929)
hertz           Reference solutions of smooth elastic contact: line contact, approach of finite bodies, elliptical
                point contact
round_bodies    Closed forms of round bodies in plane elasticity, the references of wheel pins, rollers and races
==============  ============================================================
"""
