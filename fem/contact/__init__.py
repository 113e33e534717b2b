"""Contact between condensed bodies: mortar integrals of a pair and pressures that never pull.

Modules in the order data passes:

=================  ============================================================
coupling           Integrals over one contact pair: exact gaps, resultants and loads on the side opposite
unilateral         Unilateral contact on condensed bodies: pressures that never pull and gaps that never close below
                   zero
pressure_measures  What is read from the pressure unknowns of one contact: resultant, half-width, peak, means at the
                   vertices
subsurface_shear   Largest shear stress below a contact, from recovered nodal stresses
two_bodies         Two bodies pressed together along one direction: the smallest use of the contact machinery
=================  ============================================================
"""
