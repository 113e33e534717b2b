"""Commands of ``cyclo`` that this package brings."""
