"""Studies: a grid of runs with what each combination's accuracy costs in time.

``mpmfw.study`` is the way in. Nothing is imported here, so that worker processes load no more than they need.
"""
