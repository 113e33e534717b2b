"""Export of parts: exact outlines as splines and circles, drawings and tables of points.

==============  ============================================================
simulators      A reduced drive for simulators: MJCF, URDF, Modelica, FMI, tables
flank_outline   The flank of a part as it is made, and one periodic cubic spline through it to a fifth of a micron
parts           Which bodies a part has, in which frame: disc, pin wheel, pin shaft, assembly; compensated for printers
drawing         DXF by ezdxf
point_tables    CSV: points, normals and curvature of flanks, places and radii of circles
==============  ============================================================

Solids (STEP, STL) need gmsh: `fem.export`.
"""
