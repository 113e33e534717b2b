"""What is told of the fields of a drive file: ``cyclo fields`` and the reference pages.

Modules in the order data passes:

==================  ============================================================
field_descriptions  Every field with unit, default, bounds and meaning, read off the definitions themselves
engine_support      Which engine refuses which fields, by name
==================  ============================================================
"""
