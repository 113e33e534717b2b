"""One disc with wheel, crank and pin shaft at one crank angle: what presses, meshes, model, loaded pose, results.

Modules in the order data passes:

=================  ============================================================
contact_kinds      The kinds of contacts, and what each is called in results, tables and pictures
rigid_bodies       The bodies as rigid ones: places, approaches, gaps
expected_contacts  Where contacts are to be expected at a crank angle, with which load and half-width: a guess, for
                   grading meshes
supports           What holds pins and cranks: ring and bearing of the wheel, beams, springs, posts, shafts
meshes             Meshes of all bodies of a drive, graded for the contacts expected at a crank angle
model              Condensed finite-element model of a drive on given meshes: bodies, contact pairs, compliance at a
                   pose
condensed          Condensation of all bodies of a drive: zones on the meshes, one factorisation for each distinct
                   mesh
pose               Iteration of the pose: contact solved about the pose of the bodies, bodies moved there, gaps
                   rebuilt
contact_results    From contact unknowns to the numbers of each part: loads, peak pressures, half-widths, forces on
                   the disc
grading            The contacts to grade meshes for at a given pose, and why meshes do not serve a solution
full_solution      Solution of one disc with wheel, crank and pin shaft at one crank angle, and what follows from it
solution           The way to it: coarse, graded anew, fine, checked
fields             Fields of a full solution on the nodes of every body, in the fixed frame at the loaded pose
disc_stress        Stress in the disc of a full solution: along flank, bore and hole walls, and below its contacts
=================  ============================================================
"""
