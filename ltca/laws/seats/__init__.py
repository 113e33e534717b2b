"""Conforming seats: what `ltca.laws.conforming` is made from.

Modules in the order data passes:

===========  ============================================================
sleeve_wall  What a sleeve has beyond an infinite body: harmonics of a ring pressed from within and outside
arc          Contact of a conforming seat over a given arc: pressure, play and approach in units of the load
series       Arc, pressure and approach of a conforming seat over the load, from Hertz to the neat fit: one Chebyshev
             series each
===========  ============================================================
"""
