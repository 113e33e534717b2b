"""Loads of all pairs at a pose: how the bodies yield, two kinds of models behind one interface.

Modules in the order data passes:

===================  ============================================================
rollers              A roller between the races: two contact laws in series, its radial place eliminated (Eq. 52, 57,
                     66)
leaning_rollers      Rollers of a crank bearing in slices: place and lean at which both contacts balance in force and
                     moment
sliced               What contacts in slices are made of, loaded when a drive has them
stored_energy        Energy that the contacts of a disc store, and the work of contacts that move over the bodies
contact_laws         Laws of all contacts of a disc, whatever bodies lie behind them
inner_unknowns       What is unknown beside the pose: places of rollers, deformations, displacements of pins
response             What a compliance model answers: loads of all contact pairs at a pose, their generalised force and
                     its tangent
pressures            Pressures behind the loads found: read from the laws of the contacts, for shaft pins from their
                     loads
in_slices            Contacts of a disc in slices at a pose: how they tilt, what they carry, force and tangent of the
                     disc
uncoupled            Contacts that do not feel each other: every load follows from its approach alone
half_space           Half-space compliance: pairs that do not feel each other (the paper's model)
stress_coefficients  Stress along the walls of the disc by the loads on it: reading from the coefficient file, and the
                     stress they give
coefficients         Influence coefficients of the bodies derived from finite elements: the file, and their values at
                     any place
solid_cylinder       What a solid cylinder with free ends yields at a contact, beyond one in plane strain
near_field           Near fields of all contacts of a drive, and what finite elements have beyond them: the diagonal of the
                     body part C
coefficient_files    Where influence coefficients come from: files of the user's, or derived once for each distinct
                     shape and kept
ring                 Flexibility of the ring of the pin wheel: a curved beam, or finite elements from a file
undeformed           Overlap of the undeformed bodies at a pose, and where on the disc each contact lies: what coupled bodies
                     start from
coupled              Loads of all contact pairs at a pose when the pairs feel each other through the bodies (`fe` and
                     `hybrid`)
coupled_slices       Contacts in slices that feel each other through the bodies
wall_stress          Stress in the disc under the loads found: along lobe roots, bore and hole walls, and in the wall
                     under each contact
===================  ============================================================
"""
