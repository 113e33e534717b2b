"""Solid bodies: plane meshes extruded along their axis, with free ends, linear elasticity in three dimensions.

A body of one cross-section is the product of a plane mesh and of layers along its axis, and so is its stiffness: sums of
products of small matrices, no mesh in three dimensions. Modules in the order data passes:

===========  ============================================================
layer_count  How many layers half of a body may have
layers       Layers along the axis: quadratic, graded towards the free ends, of half of a body or of all of it
section      Integrals of the shape functions over the cross-section
extruded     An extruded body: unknowns, stiffness, rigid motions, loads spread along the axis
order        Order of elimination: nested dissection of the vertices in three dimensions
factor       Factors of large symmetric matrices: CHOLMOD where it is installed, else SuperLU
===========  ============================================================
"""
