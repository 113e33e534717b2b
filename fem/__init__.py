"""Plane-strain finite elements of the disc, the pins and the rollers of a cycloidal gear drive.

Modules in the order data passes:

=======================  ==================================================================================
geometry                 exact boundary curves of each body, from a drive
hertz                    half-width and peak pressure of a line contact
expected_contacts        guess of places, loads and half-widths of all contacts at a crank angle
element_size             refinements, and the size field they make
boundary_division        exact curves divided into edges by the size field
memory                   memory a mesh or solution will need, refused where there is too little
gmsh_session             gmsh, loaded when needed
meshing                  curved quadratic triangles of one body
body_mesh                the mesh as a value: nodes, elements, named boundaries
quality                  smallest angle and scaled Jacobian, measured and checked
drive_mesh               meshes of all bodies of a drive
mesh_file                ``.msh`` and ``.vtu``
offscreen                whether pyvista can render here
mesh_picture             picture of a drive's mesh
stations                 places on the disc where coefficients are derived, widths of the patches
surface_patch            semi-elliptic patches on meshed boundaries: loads that also measure
free_body                datum of a floating body: best-fit rigid motion of a boundary
influence_coefficients coefficients of disc, pin, roller and race
coefficient_dataset      all of them as one labelled dataset
coefficient_file         ``coefficients.nc``
coefficient_checks       laws that a file must obey
fixtures                 regenerates ``meshes/``
commands                 what the package adds to ``cyclo``
=======================  ==================================================================================
"""
