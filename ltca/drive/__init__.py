"""What a drive is: frozen definitions of its parts, their deviations and tolerances; nothing computed.

Modules in the order data passes:

============  ============================================================
units         Quantities of the drive file: plain numbers are mm, N, MPa, N·mm, rad; a text may carry another unit
deviations    Deviations of real parts from their drawing: part of the drive's definition, all zero unless given
parts         The drive: validated, frozen definitions of its parts, clearances and load (mm, N, MPa, N·mm, rad)
plane_strain  What two dimensions cannot say about a drive: whatever varies along the length of its rollers and pins
fields        Fields of a drive by dotted path: read, count, unit
mistakes      Mistakes in a definition as sentences: field, value, bound
tolerances    Distributions of the fields of a drive: the ``[tolerances]`` table that studies read
============  ============================================================
"""
