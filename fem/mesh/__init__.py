"""Meshes of single bodies: size field, triangulation, quality, files.

Modules in the order data passes:

==================  ============================================================
element_size        Size field of a body: balls of small elements that grow into a coarse interior
boundary_division   Division of the exact boundary curves into edges that follow the size field
memory_need         Memory a mesh or a solution will need, estimated before any work, against what the machine has
gmsh_session        gmsh, loaded when needed, with one clear message where its system libraries are missing
triangulation       Meshes of the bodies: boundary on the exact curves, interior by gmsh, curved quadratic triangles
disc_parts          A disc as a core and cells of its walls, of which there are copies
body_mesh           The mesh of one body: curved triangles with named boundaries, as a value
quality             Quality of a mesh: smallest angle and scaled Jacobian, reported and checked
uniform_refinement  Every triangle in four, every boundary edge in two, boundary nodes on the exact curves
mesh_file           Meshes on disk: ``.msh`` (gmsh 2.2, groups kept, both orders) and ``.vtu`` (curved quadratic
                    cells)
placed_body         The mesh of a body at its place in the drive
==================  ============================================================
"""
