"""Commands that look things up.

==========  ============================================================
fields      Fields of a drive file: unit, default, bounds, meaning, and which engines take them
quantities  What results are called in studies, aims and limits
==========  ============================================================
"""
