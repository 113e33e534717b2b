"""Influence coefficients of the bodies: places, loads, derivation. Their file and its laws are in `ltca.reading`.

Modules in the order data passes:

=============  ============================================================
stations       Stations: the places of a disc at which influence coefficients are derived, and the patches they carry
patch_loads    Patches with semi-elliptic pressure on meshed boundaries: loads, and the means by which they measure
wall_strain    Tangential strain of walls as a linear measure of the displacement, for the stress stations
bodies         Normal approach influence coefficients of the bodies of a drive, derived by finite elements
pieces         Pieces of a long derivation, kept in the cache until all of it is done
solid_bodies   What coefficients of solid bodies are beyond those of plane strain, on extruded meshes
solid_need     Memory and time that a solid disc will need, estimated beforehand
solid_dataset  Coefficients of the solid bodies of a drive: those of plane strain with what solid bodies have beyond them
dataset        All influence coefficients of a drive as one labelled dataset, the content of ``coefficients.nc``
fit            Check that a file of influence coefficients belongs to the bodies of a drive: dimensions and stations
ring           Flexibility of the ring of the pin wheel at its seats and bolts, as a labelled dataset
=============  ============================================================
"""
