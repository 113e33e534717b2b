"""Mechanics of a reducer at a pose: its contacts, their laws, and everything elastic that couples them, in one linear system.

===============  ================================================================================================
displaced_pins   Contacts on pins that beams and the ring displace: how they follow, and what they press
laws             Laws of all contacts, in the plane or in slices
places           Places of the contacts of a disc at poses, and the inner unknowns
pressing         What contacts press the coordinates of discs with, rollers where they stand
elimination      Deformations, displacements of pins and places of rollers eliminated
contacts         All contacts at poses with everything elastic that couples them, linearised
full_tangent     The whole tangent: with what a search leaves out
answers          What the contacts of a disc answer at poses
energy           What contacts store, with the bodies and pins behind them
===============  ================================================================================================
"""
