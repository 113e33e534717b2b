"""Discs of solid bodies at one crank angle: all contacts in three dimensions, with leads, profiles and inclinations.

Meshes of sections, zones, poses and gaps at mid-width, supports and the way to a solution are those of `fem.drive`. Modules in
the order data passes:

===============  ============================================================
along_width      What of a drive varies along the width: lengths, layers, reliefs and leans
solid_model      Condensed solid bodies with all pairs of a disc: what is theirs in the contact problem
solid_bodies     Condensation of disc, pins, rollers and race as extruded bodies
width_results    From the pressures of a solution to loads, moments, pressures along the width and tilts of the disc
solved_discs     Gradings for solid bodies, from a plane solution on; memory they need
===============  ============================================================
"""
