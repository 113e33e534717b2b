"""Other methods to balance a drive, for comparison.

Modules in the order data passes:

==============  ============================================================
grid_pressures  Pressures along the width from half-space grids of contacts that tilt
pressed_grid    Contacts on half-space grids at every approach of an equilibrium: load, stiffness, pressures
grids           Contact grids solved inside every iteration of the equilibrium: the contacts of the ``direct`` method
unloaded        Unloaded transmission error, and pairs that can carry (Eq. 2–6)
paper_method    The iteration of the paper: wheel held, crank leads, Newton with finite-difference tangents (Eq.
                43–46, 90–93)
clearance_free  Loaded tooth contact analysis of a drive without bearing and pin-hole clearance: one linear system
                (Eq. 7–40)
==============  ============================================================
"""
