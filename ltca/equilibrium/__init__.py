"""The pose that balances; modules in the order data passes.

=================  ============================================================================================
reducer            A reducer of several discs: each with its own joints to wheel, crank and pin shaft
friction           Friction of the joints: what slips, and the forces that follow
first_stage        First stage: forces of the sun on the planets of the cranks, and the angle of its teeth
external_force     Forces and moments from outside on the output
supports           Springs on coordinates: crankshafts on their bearings, and the wheel on its own
newton             Damped Newton iteration for the pose in which a batch of positions balances
neighbours         Which positions of many are balanced first, and the poses of those between them
balance            Equilibrium of the floating discs at held crank angles (Eq. 43–44, 70–72, 85–89)
output_angle       The angle of the wheel with the input held, and its free play
output_torque      Equilibrium at a given torque of the output, whichever member is held
partial_balance    Balance as many positions as have an answer: one that has none costs the others nothing
compliance_shares  Shares of the parts of the reducer in the compliance of its output
=================  ============================================================================================
"""
