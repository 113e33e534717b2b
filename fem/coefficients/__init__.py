"""Influence coefficients of the bodies: places, loads, derivation, file and its checks.

Modules in the order data passes:

===========  ============================================================
stations     Stations: the places of a disc at which influence coefficients are derived, and the patches they carry
patch_loads  Patches with semi-elliptic pressure on meshed boundaries: loads, and the means by which they measure
wall_strain  Tangential strain of walls as a measure of the displacement: what stress stations read
bodies       Normal approach influence coefficients of the bodies of a drive, derived by finite elements
dataset      All influence coefficients of a drive as one labelled dataset, the content of ``coefficients.nc``
laws         Checks of a file of influence coefficients by laws that need no second computation
schema       What a file of influence coefficients must hold to be used, and whose bodies it belongs to; whoever made
             it
file         ``coefficients.nc``: written whole or not at all, read back as the dataset that was written
===========  ============================================================
"""
