"""What `import ltca` gives beside `ltca.facade`: the commands that answer one question, as functions.

==========  ===================================================================================
arguments   What these functions take: drives, torques, angles, engines
checks      `ltca.check`: the verdict of ``cyclo check``
curves      `ltca.curves`: torque curve, orders, lives, pressure of ``cyclo curves``
joined      `ltca.concat`: several results in one dataset
motions     `ltca.motion`: a run in time of ``cyclo dynamics --time``
pressures   The pressure over one contact of a result, as a labelled array
vibrations  `ltca.vibration`: modes, critical speeds, response over speed of ``cyclo dynamics``
==========  ===================================================================================
"""
