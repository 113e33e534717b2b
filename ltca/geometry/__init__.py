"""Where everything is and how far it is pressed together at a pose; no forces.

Modules in the order data passes:

=================  ============================================================
rotation           Points of the unit circle without trigonometry where products do: e^{iφ}, its integer powers and
                   small turns
boundary_stations  Stations of a closed boundary, uniform in a periodic parameter, and the interpolation between them
flank_deviation    Deviation of the flank from its design along the design normal, δ(θ), with two derivatives
placement          Where pins, rollers and holes stand and how large they are, errors included
flank              Cycloid flank with equidistant and shifting offset, its normals, curvature and nearest point (Eq. 1)
coordinates        Which coordinates a pose has and where: discs, cranks that yield, the wheel where its bearing does,
                   the wheel's angle
pair_motion        What the geometry answers of pairs at a pose: approaches, derivatives, and what bounds them elsewhere
pairs              How far each pair is pressed together at a pose, and how that changes with the pose (Eq. 45–64)
interference       How far parts overlap as they are drawn, before any body yields: what presses a drive together
                   without load
first_contact      Tooth contact analysis without load: backlash, unloaded transmission error, pairs that can carry
                   (Eq. 2–6)
play               How far the wheel can turn while no body gives: the play of all clearances together, discs floating
separation         True separation of two touching surfaces along their common tangent (Eq. 17–19, 53–58, 65)
=================  ============================================================
"""
