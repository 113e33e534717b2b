"""A reduced drive (`ltca.analysis.reduced_model`) in the formats of simulators.

======================  ============================================================
files                   Which files a format has, and writing them
lookup_tables           JSON with everything, tables as CSV, and what they mean
mujoco_model            MJCF: joints of input and output, a tendon as the spring with play, motor
mujoco_callback         What MuJoCo cannot say: hysteresis, transmission error, friction that goes with the load
urdf_model              URDF: joint with limits and friction, transmission
modelica_package        Modelica 4: a component between two flanges
functional_mockup_unit  FMI 2.0 for co-simulation, with its C sources, compiled where there is a compiler
======================  ============================================================
"""
