"""Finite elements of the disc, the pins and the rollers of a cycloidal gear drive: in plane strain, and as solid bodies.

Folders in the order data passes; each one's docstring lists its modules.

====================  ============================================================
errors                what the package raises on purpose
shapes                Exact shape of each body of a drive: closed curves with names, in the frame of the body
mesh                  Meshes of single bodies: size field, triangulation, quality, files
body                  One meshed body: elasticity, its boundary zones, its compliance, its stresses
solid                 Extruded bodies in three dimensions: layers, stiffness, factors
options               Options of a full solution: element size, plane state, fine walls, layers of solid bodies
discretisation_error  Error of a figure by the size of the elements, from solutions on at least three meshes
contact               Contact between condensed bodies: mortar integrals of a pair and pressures that never pull
drive                 Discs with wheel, cranks and pin shaft at one crank angle: expected contacts, graded meshes, condensed
                      models, loaded poses, results
solid_contact         Contact between extruded bodies in three dimensions: pressures over arc and width
solid_drive           Discs of solid bodies with all their contacts: pressures over arc and width, tilts
reducer               All discs of a drive on one wheel, plane or solid, either member held, and the files of a solution
coefficients          Influence coefficients of the bodies: places, loads, derivation
referee               The same problem given to another code
pictures              Pictures of meshes and solutions
export                Solids of parts: STEP and STL
testing               Fixtures and reference values of the regression tests
commands              Commands that the package adds to ``cyclo``
====================  ============================================================
"""
