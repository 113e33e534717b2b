"""Plane-strain finite elements of the disc, the pins and the rollers of a cycloidal gear drive.

Modules in the order data passes:

========================  ======================================================================================
geometry                  exact boundary curves of each body, from a drive
hertz                     half-width and peak pressure of a line contact
expected_contacts         guess of places, loads and half-widths of all contacts at a crank angle
element_size              refinements, and the size field they make
boundary_division         exact curves divided into edges by the size field
memory                    memory a mesh or solution will need, refused where there is too little
gmsh_session              gmsh, loaded when needed
meshing                   curved quadratic triangles of one body
body_mesh                 the mesh as a value: nodes, elements, named boundaries
quality                   smallest angle and scaled Jacobian, measured and checked
drive_mesh                meshes of all bodies of a drive
mesh_file                 ``.msh`` and ``.vtu``
offscreen                 whether pyvista can render here
mesh_picture              picture of a drive's mesh
elasticity                stiffness, rigid modes, distributed loads, energy
condensation              one factorisation: compliance of all loads of a body
surface                   zones that carry pressure, zones opposite
coupling                  mortar integrals of a pair: exact gaps, one line of action
unilateral                pressures that never pull: active set, interior point
two_bodies                two bodies pressed together
shaft_pins                elastic shaft pins, an option
drive_model               bodies and pairs of a drive, its contact problem at a pose
drive_condensation        the model from meshes
pose                      iteration of the loaded pose
grading                   contacts to grade meshes for, from a solution
contact_results           loads, peak pressures, half-widths, forces on the disc
solution                  full solution: coarse, graded, checked
stress                    recovery of nodal stresses
fields                    displacement and stress of all bodies, motion of the bore
solution_files            ``summary.json``, ``fem.nc``, ``.vtu``
scene                     flat scenes by pyvista or matplotlib
pictures                  von Mises, contacts, deformed shape
calculix                  deck of the same problem for CalculiX
calculix_referee          its answer beside ours
stations                  places on the disc where coefficients are derived, widths of the patches
surface_patch             semi-elliptic patches on meshed boundaries: loads that also measure
free_body                 datum of a floating body: best-fit rigid motion of a boundary
influence_coefficients    coefficients of disc, pin, roller and race
coefficient_dataset       all of them as one labelled dataset
coefficient_file          ``coefficients.nc``
coefficient_checks        laws that a file must obey
reference_fields          regenerates the fields of the regression test
fixtures                  regenerates ``meshes/``
commands                  what the package adds to ``cyclo``
========================  ======================================================================================
"""
