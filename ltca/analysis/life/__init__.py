"""Rating life and static safety of the crank bearings from the loads of their rollers.

Modules in the order data passes:

================  ============================================================
ratings           What a bearing of its size bears: ratings of its races and of the whole (ISO 281, ISO 16281:2025, ISO 76)
laminae           Load of a roller over slices of its length, by its own profile
equivalent_load   Equivalent roller load of a race: means over the time at each of its places, and over its places
passages          Which roller presses where on its races, position by position
modification      Lubricant and contamination: the factor a_ISO of ISO 281
bearing_lives     Life of every crank bearing, over every entry of the duty
life_text         What is told of lives: entries of a summary, the table of a JSON file, lines for the terminal
================  ============================================================
"""
