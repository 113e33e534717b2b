"""Loaded tooth contact analysis of cycloidal gear drives."""
