"""Contact between extruded bodies in three dimensions: pressures over arc and width, free ends, tilt, profiles.

Pressure is the product of hats along the arc and along the width, and displacements of extruded bodies are products
as well: what a pressure does to a body is the plane mortar integral (`fem.contact.coupling`) times one along the
width. Modules in the order data passes:

===========  ============================================================
widths       Pressure hats along the width: moments, integrals with the layers of a body, classes of a symmetric body
bodies       A body reduced to the pressures on its faces, class by class; held or floating
block        A block of a body around a contact: structured quadrilaterals graded to the contact
pressing     One or more faces pressed together: gaps with profile and tilt, unilateral pressures, balance and energy
reliefs      By how much the surfaces of a drive's contacts fall short along the width
pair_shapes  One pair of bodies cut out of a drive: surfaces, lengths, materials, profile, lead, expected load
displaced    Gaps between displaced surfaces, and what they differ by from linear ones
solved_pair  Two blocks pressed together: meshes graded to the contact, solution, pressures along the width, errors
pair_files   Files and words of a solved pair
===========  ============================================================
"""
