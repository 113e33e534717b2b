"""Places of all parts and approaches of all pairs at a pose, no forces; modules in the order data passes.

=================  ============================================================
rotation           Points of the unit circle: e^{iφ}, its integer powers and small turns
boundary_stations  Stations of a closed boundary and the interpolation between them
length_profile     Profiles of rollers and pins along their length, leads of flanks
flank_deviation    Deviation of the flank from its design along the design normal, δ(θ)
placement          Places and radii of pins, rollers and holes, errors included
flank              Cycloid flank: its normals, curvature and nearest point (Eq. 1)
coordinates        The coordinates of a pose and their places: discs, cranks that yield, the wheel, the ring
pair_motion        Approaches of pairs at a pose, and their derivatives by the pose
pairs              Approach of each pair at a pose and its derivatives by the pose (Eq. 45–64)
interference       Overlap of the parts as drawn, before any body yields
first_contact      Tooth contact analysis without load: first contact, backlash, interference
play               Free play of the wheel with all clearances together, crank held, discs floating
separation         True separation of two touching surfaces along their common tangent (Eq. 17–19, 53–58, 65)
=================  ============================================================
"""
