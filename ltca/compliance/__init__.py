"""How the contacts of a disc and the bodies behind them yield: two kinds of models behind one interface.

Modules in the order data passes:

===================  ============================================================
sliced               What contacts in slices are made of, loaded when a drive has them
response             Contacts at a pose: loads of all pairs, their generalised force and its tangent; laws of a disc
pressures            Pressures behind the loads found: read from the laws of the contacts, for shaft pins from their loads
half_space           Half-space compliance: pairs that do not feel each other (the paper's model)
stress_coefficients  Stress along the walls of the disc by the loads on it
coefficients         Influence coefficients of the bodies derived from finite elements: the file, and their values at any place
solid_cylinder       What a solid cylinder with free ends yields at a contact, beyond one in plane strain
near_field           Near fields of all contacts of a drive, and what finite elements have beyond them
coefficient_files    Where influence coefficients come from: files of the user's, or derived once for each shape and kept
pin_flexibility      Flexibility of what holds pins: beams under several discs, and the ring of the wheel
ring                 Flexibility of the ring of the pin wheel: a curved beam, or finite elements from a file
coupled              Contacts that feel each other through the bodies (`fe` and `hybrid`)
wall_stress          Stress in the disc under the loads found: along its walls, and in the wall under each contact
===================  ============================================================
"""
