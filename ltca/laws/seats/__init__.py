"""Conforming seats, for `ltca.laws.conforming`; modules in the order data passes.

===========  ============================================================
sleeve_wall  Harmonics of a sleeve less those of an infinite body: a ring under pressure inside, a line force outside
arc          Contact of a conforming seat over a given arc: pressure, play and approach in units of the load
series       Arc, pressure and approach over the load, from Hertz to the neat fit: one Chebyshev series each
===========  ============================================================
"""
