"""Measured flanks: from a file of points to the deviation of a flank along its normal.

=========  ============================================================
points     CSV files of measured points: columns x and y in mm, others by their names
deviation  Points as the deviation of a flank from its design, over θ
tables     Measured flanks in a drive file, read into its profile errors
=========  ============================================================
"""
