"""Pages of commands that study a drive.

========  ============================================================
check     A verdict with what drives each value and what would mend it
curves    Torque curve, orders of the transmission error, life, flank pressure
dynamics  Modes, critical speeds, response over speed
time_run  A drive in time: transmission error, loads, spectrum, balance of energy
samples   A tolerance study or a sweep: what each quantity reaches over the samples, and what matters
designs   Designs beside each other, the outline of each, or what stands in the way
optimum   The drive as it is and the one that was found
========  ============================================================
"""
