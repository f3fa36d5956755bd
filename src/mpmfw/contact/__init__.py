"""Contact is a detection and a law, joined by rows.

A detection lists the rows: places where two bodies may touch, with normal, gap, area and the grid nodes whose
motion makes up theirs. A law turns rows, their motion and their history into forces or impulses. Neither
knows the other; what acts on the grid, the stable step and the pairs' records are shared.
"""
