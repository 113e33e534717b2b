"""The pose that balances.

Modules in the order data passes:

==============  ============================================================
reducer         A reducer of several discs: every disc a member with its own joints to wheel, crank and pin shaft, one wheel
                for all
newton          Damped Newton iteration for the pose in which a batch of positions balances
balance         Equilibrium of the floating discs at held crank angles (Eq. 43–44, 70–72, 85–89)
output_torque   Equilibrium at a given torque of the output, whichever member is held
paper_method    The iteration of the paper: wheel held, crank leads, Newton with finite-difference tangents (Eq.
                43–46, 90–93)
clearance_free  Loaded tooth contact analysis of a drive without bearing and pin-hole clearance: one linear system
                (Eq. 7–40)
==============  ============================================================
"""
