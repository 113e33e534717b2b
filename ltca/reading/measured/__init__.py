"""Measured flanks: from a file of points to the deviation of a flank along its normal.

=========  ============================================================
points     A CSV file of measured points: what it holds, or what is wrong with it in one sentence
deviation  Points as the deviation of a flank from its design, over θ
tables     Where a drive file names such files, and the drive with what they hold
=========  ============================================================
"""
