"""One meshed body: elasticity, its boundary zones, its compliance, its stresses.

Modules in the order data passes:

================  ============================================================
elasticity        Plane linear elasticity of one meshed body: stiffness, rigid modes, distributed loads, energy
surface           Contact zones on meshed boundaries: the side that carries the pressure and the side opposite
sparse_factor     Factors of sparse matrices, and what is said where memory is not enough for one
condensation      Condensation of a body to its loads: one sparse factorisation gives the compliance of all of them
free_body         Datum of a floating body: its displacement relative to the best-fit rigid motion of some boundaries
influence         Influence between very many loads of a free body: only the blocks that are asked for, none by a dense factor
joined_parts      A body of parts of which there are copies: each is condensed once to the nodes that it shares
stress            Stress recovery: from nodal displacements to nodal Cauchy stresses
wall_stress       Stress along a meshed boundary, from recovered nodal stresses
plane_references  Closed forms that stresses along walls are held against, and a free body under loads
pin_ring          The ring of the pin wheel: forces of pins on its seats and of bolts, flexibility between them
================  ============================================================
"""
