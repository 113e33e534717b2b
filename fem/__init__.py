"""Plane-strain finite elements of the disc, the pins and the rollers of a cycloidal gear drive."""
