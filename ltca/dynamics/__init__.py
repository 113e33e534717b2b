"""Masses of a drive, its vibrations about a balanced position, and its motion in time; modules in the order data passes.

================  =======================================================================================
masses            Volume, mass, centre and inertia of every part, and the unbalance of the discs
kinetics          Coordinates of a vibrating drive, its mass matrix, inertia referred to input and output
stiffness         Stiffness about balanced positions over the same coordinates
modes             Eigenfrequencies and modes, and what moves in them
harmonic_balance  Motion on a stiffness that pulses over the turn: Hill's equation, parametric resonance
kinetic_energy    Kinetic energy over the crank angle, and the inertia forces of a motion
teeth             Teeth of a first stage on cranks, flange and wheel at one instant
contact_forces    Forces of contacts, supports and friction of a drive at one instant
massless          Parts that yield and have no mass, which follow all others
motion            Equation of motion
================  =======================================================================================
"""
