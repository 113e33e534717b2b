"""A verdict on a design: what its results reach, against limits that each have a source.

Modules in the order data passes:

===========  ===============================================================================
geometry     Margins of the shape: undercut, hollow against pin, walls, gaps between rollers
proportions  Sizes that look odd beside those of published drives
pin_stress   Bending and shear stress of pins that are beams, under the forces of all discs
places       Where a quantity is largest: part and crank angle
assembly     Plays at temperature; deflections of bearings and supports against the clearance
duty         Entries of a duty that ask more than the load
values       What is judged: values with the part and the crank angle where they are reached
advice       Which inputs drive a value, and how much of which would mend it
lead_crown   The crown of the flank that takes the load off the ends of the contacts
drive_check  The verdict on one drive: checks, advice and notes together
===========  ===============================================================================
"""
