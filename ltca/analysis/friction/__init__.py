"""What friction costs and does: losses of a drive that turns, and the loop of one whose input is locked.

Modules in the order data passes:

==========  ===============================================================================
losses      Slip, friction force and power of every joint; efficiency; whether the drive moves back
variables   What friction adds to dataset and summary of a run
hysteresis  Torque against wind-up with the input locked: contacts that stick and slip
==========  ===============================================================================
"""
