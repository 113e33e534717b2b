"""The same problem given to another code.

Modules in the order data passes:

=============  ============================================================
calculix_deck  Input deck of the same problem for CalculiX: CPE6 elements, surface-to-surface penalty contact
calculix       CalculiX as a second opinion: runs the exported deck, reads contact forces and pressures, compares
calculix_pair  A pair of solid blocks given to CalculiX: C3D20R on the same mesh, both answers side by side
=============  ============================================================
"""
