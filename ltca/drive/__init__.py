"""What a drive is: frozen definitions of its parts, their deviations and tolerances; nothing computed.

Modules in the order data passes:

=============  ============================================================
units          Units of the drive file: what a text may carry, and how a field checks it
names          Names of drives and cases: files and folders are called after them, and they are printed, drawn and put on
               pages
deviations     Deviations of real parts from their drawing: part of the drive's definition, all zero unless given
materials      What parts are made of, linear-elastic, and the profile they are ground to along their length
members        Parts that take a page of their own: crankshafts, and the pins of wheel and shaft
fingerprints   Hashes of definitions: what is at its default is left out, so that a field that later versions add changes none
parts          The drive: validated, frozen definitions of its parts, clearances and load (mm, N, MPa, N·mm, rad)
single_discs   A drive of several discs as drives of one disc each, and how far each flank is turned against its holes
plane_strain   What some models cannot say about a drive: what varies along rollers and pins, several cranks, supports, loose
               pins
unit_mistakes  Likely mistakes of units behind a drive that cannot carry its load: looked for when a solution fails, never
               before
fields         Fields of a drive by dotted path: read, count, unit
mistakes       Mistakes in a definition as sentences: field, value, bound; a misspelt name with the one that was meant
tolerances     Distributions of the fields of a drive: the ``[tolerances]`` table that studies read
reference      What is told of the fields: unit, default, bound, meaning, and which engine takes them
=============  ============================================================
"""
