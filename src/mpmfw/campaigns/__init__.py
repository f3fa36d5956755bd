"""A campaign: points of a grid, the runs that they need, and one dataset of their results.

``mpmfw.campaign`` is the way in; ``compare``, ``study``, ``stability`` and ``validate`` judge it. Nothing is
imported here, so that worker processes load no more than they need."""
