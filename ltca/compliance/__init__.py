"""How the contacts of a disc and the bodies behind them yield: two kinds of models; modules in the order data passes.

===================  ============================================================
sliced               What contacts in slices are made of, loaded when a drive has them
response             Contacts at a pose: loads of all pairs, their generalised force and its tangent; laws of a disc
pressures            Pressures from the laws of the contacts, of shaft pins from their loads
half_space           Half-space compliance: pairs that do not feel each other (the paper's model)
stress_coefficients  Stress along the walls of the disc by the loads on it
coefficients         Influence coefficients of the bodies by finite elements: the file, and their values at any place
solid_cylinder       Yield of a solid cylinder with free ends at a contact, beyond one in plane strain
near_field           Near fields of all contacts of a drive, and the parts of bodies beyond them
coefficient_files    Files of influence coefficients: the user's, or derived once for each shape and kept
pin_flexibility      Flexibility of what holds pins: beams under several discs, and the ring of the wheel
ring                 Flexibility of the ring of the pin wheel: a curved beam, or finite elements from a file
coupled              Contacts that feel each other through the bodies (`fe` and `hybrid`)
wall_stress          Stress in the disc along its walls, and in the wall under each contact
===================  ============================================================
"""
