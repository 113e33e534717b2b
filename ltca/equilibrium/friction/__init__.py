"""Friction of the joints: what slips, and the forces that follow; modules in the order data passes.

=========  ==========================================================================================
slip       How contacts slip by the pose and by the crank angle
turning    Coulomb friction and rolling resistance of a drive that turns
sticking   Friction of contacts that stick or slip while the input is locked
=========  ==========================================================================================
"""
