"""Studies: grids of runs with the error and the cost of each combination.

``mpmfw.study`` is the entry point. Nothing is imported here, so that worker processes load no more than they
need.
"""
