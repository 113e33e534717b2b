"""Masses of a drive and its vibrations about a balanced position.

Modules in the order data passes:

================  ============================================================
masses            Volume, mass, centre and inertia of every part, and the unbalance of the discs
kinetics          Coordinates of a vibrating drive, its mass matrix, inertia referred to input and output
stiffness         Stiffness about balanced positions over the same coordinates
modes             Eigenfrequencies and modes, and what moves in them
harmonic_balance  Motion on a stiffness that pulses over the turn: Hill's equation, parametric resonance
mass_values       Masses, unbalance and inertias as results hold and print them
================  ============================================================
"""
