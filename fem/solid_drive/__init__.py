"""A whole disc of solid bodies at one crank angle: all its contacts in three dimensions, with leads, profiles and inclinations.

The plane part is that of `fem.drive`: meshes, zones, poses and gaps at mid-width. Modules in the order data passes:

===============  ============================================================
along_width      What of a drive varies along the width: lengths, layers, reliefs and leans; the drive without it
solid_model      Condensed solid bodies with all pairs of a disc, and their contact problem at a pose
solid_bodies     Condensation of disc, pins, rollers and race as extruded bodies; memory they need
width_results    From the pressures of a solution to loads, moments, pressures along the width and tilts of the disc
solved_disc      The way to it: plane solution, meshes graded for it, solid bodies, checked
solid_files      Files and words of a solution: summary, dataset, table
===============  ============================================================
"""
