"""Load–approach laws of single contacts: tables of the half-space, plane strain, springs; modules in the order data passes.

=====================  ============================================================
contact_law            Base class of the laws: load, stiffness, energy, pressure, half-width, approach at a load
spring                 A contact that yields like a linear spring
slenderness_curve      Quintic splines on uniform knots over the slenderness of a line contact
line_contact           An uncrowned line contact between two half-spaces
sliced_contact         State of contacts in slices, whatever their law, and where a neighbour starts from
sliced_line            Line contacts in slices along their width: load and moment by approach and tilt
separate_slices        Contacts in slices that do not feel each other: a law of the plane at every height
sliced_seat            Conforming seats in slices behind a contact
width_pressure         Pressures along the width, from slices and from grids that tilt
profiled_line_contact  Line contacts that are crowned or relieved along their length
plane_strain           A line contact in plane strain, with a datum
seats                  Conforming seats: contact over a given arc, series over the load, the wall of a sleeve
conforming             A pin in a bore that is hardly larger, with a datum; a sleeve on its pin
ring_beam              The ring of the pin wheel as a curved beam
bearing_pair           Rolling bearings in five directions in closed form, and bearings with clearance or preload
member_bearings        Stiffness and laws of the bearings of cranks and wheel, and of crankshafts between them
backed                 A contact in series with the seat of a loose pin or sleeve and with the bending of the pin
carrier                Posts and flanges of a carrier: forces on the far flange by its motion against the near one
=====================  ============================================================
"""
