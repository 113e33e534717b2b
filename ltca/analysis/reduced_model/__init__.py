"""A drive reduced to what a simulator of robots or machines can hold, with the error of the fit.

===================  ============================================================
reduced_drive        The law itself, numpy alone: torque of wind-up, hysteresis and friction; simulators get this file as it is
wind_up              Wind-up over torque and crank angle: play, mean curve, orders of the transmission error at each torque
hysteresis_elements  Maxwell-slip elements whose strength goes with the load, fitted to the loop with the input locked
input_friction       Friction at the input over torque and sense of motion, efficiency, torque that drives back
model                All of it with inertias, damping, limits, valid range, errors, fingerprint
===================  ============================================================
"""
