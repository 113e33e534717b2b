"""Pictures of meshes and solutions.

Modules in the order data passes:

=================  ============================================================
drive_loads        The drive with its loads and pressures as SVG for a page; nothing is rendered
offscreen          Whether pyvista can render off-screen here, tried in a subprocess
flat_view          Common parts of off-screen pictures of plane bodies: surfaces and lines of pyvista, a camera that
                   looks down
scene              Flat scenes of triangles and lines: fields by pyvista off-screen or, without GL, matplotlib; text
                   by matplotlib
mesh_picture       Picture of the mesh of a whole drive with zooms at its contacts: pyvista off-screen, or matplotlib
page_picture       A panel as SVG for a page: the field with a clear ground, words in the colours of the page
solution_pictures  Pictures of a full solution: von Mises over the drive, the most loaded contact of each kind, the
                   deformed shape
=================  ============================================================
"""
