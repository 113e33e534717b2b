"""Commands that this package adds to ``cyclo``."""
