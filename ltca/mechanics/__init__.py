"""Mechanics of a reducer at a pose: its contacts, their laws, and everything elastic that couples them, in one linear system."""
