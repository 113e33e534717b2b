"""A verdict on a design: what its results reach, against limits that each have a source.

Modules in the order data passes:

==========  ===============================================================================
geometry    Margins of the shape: undercut, hollow against pin, walls, gaps between rollers
pin_stress  Bending and shear stress of pins that are beams, under the forces of all discs
values      What is judged: values with the part and the crank angle where they are reached
advice      Which inputs drive a value, and how much of which would mend it
==========  ===============================================================================
"""
