"""Units of the drive file: what a text may carry, and how a field checks it.

Modules in the order data passes:

==========  ============================================================
table       The units a text may carry, and exact conversion between them
quantities  Quantities of the drive file: plain numbers are mm, N, MPa, N·mm, rad; a text may carry another unit
==========  ============================================================
"""
