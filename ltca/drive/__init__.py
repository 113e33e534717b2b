"""The definition of a drive: frozen dataclasses of its parts, their deviations and tolerances; nothing is computed.

Modules in the order data passes:

==============  ============================================================
units           Units of the drive file, and the checks of quantities and counts that types of fields carry
names           Names of drives and cases, which name files and folders and are printed and drawn
deviations      Deviations of real parts from their drawing: part of the definition of a drive, all zero by default
materials       Materials of the parts, linear-elastic, and their profiles along the length
members         Crankshafts, pins, operation and temperatures; named materials; limits and their verdict
fingerprints    Hashes of definitions without what is at its default, so that fields of later versions change none
parts           The drive: validated, frozen definitions of its parts, clearances and load (mm, N, MPa, N·mm, rad)
declaration     Every field with unit, bounds, default, meaning and growth with temperature, from the definitions
engine_support  Fields that engines refuse: the one table behind engines, finite elements and the reference pages
single_discs    A drive of several discs as drives of one disc each
pin_beams       Pins as beams, and the springs that shaft pins are equal to
hole_contact    The contact of holes and shaft pins: whether the pins are elastic there, and the modulus of the pair
ring_shape      What determines the plane finite-element ring of the pin wheel, and its fingerprint
yielding_parts  Which parts yield in the torsional stiffness, and which are rigid because a file leaves them out
fields          Fields of a drive by dotted path: values, numbers of elements, absent parts
mistakes        Mistakes in a definition as sentences: field, value, bound, and the name that a misspelt one is close to
least_torque    The least torque of a drive that can be balanced
unit_mistakes   Likely mistakes of units behind a drive that cannot carry its load
tolerances      Distributions of the fields of a drive: the ``[tolerances]`` table that studies read
==============  ============================================================
"""
