"""Compiled kernels: short loops over ``range(dim)``, one source for two and three dimensions.

They import numpy and numba alone. The dimension is the length of the tuple ``spacing``, so that numba
specialises by type and the disk cache hits. A plug-in marks its own kernels with :func:`kernel`, what they
call with :func:`device`, and takes scratch memory from :mod:`mpmfw.kernels.scratch`.

- **Files**: the time step in ``particle_grid``, tables in ``stencil``, one facet in ``facets``, closed
  ``surfaces`` and their ``boxes``, rows of ``contact``, short rows and small matrices in ``arithmetic``.
- **Types** of arguments: ``Floats``, ``Ints``, ``Indices`` are arrays of float64, int64 and int32, ``Float``
  a compiled scalar.
- **Structs**: a class derived from :class:`Struct` has arrays that kernels take as one argument,
  ``rows.gap[c]``; :func:`struct` makes one of named arrays.

Kernels check nothing: an index out of range or an array of another shape is not an error but undefined. Those
that can fail return an index, and say so. Arrays are C-contiguous; results are written to the array named for
them, or added to it where the formula has ``+=``.

Arguments of the same name mean the same everywhere. Points are material points or surface nodes, n of them,
with m entries in their table; N nodes of the grid, F velocity fields, B bodies. Extensive quantities are per
metre of thickness in 2D.

=========================== ======================== =========================================================
argument                    shape [unit]             meaning
=========================== ======================== =========================================================
``points``                                           material points, an ``mpmfw.api.Particles``
``table``                                            their interpolation table, an ``mpmfw.api.Stencil``
``grid``                                             nodes of all velocity fields, an ``mpmfw.api.Grid``
``thickness``               (n,) [m]                 of the points, or None
``flip``                    [1]                      from 0 (PIC) to 1 (FLIP)
``least_squares``                                    whether the affine field is B_p D_p⁻¹, else B_p
``row``                     (n + 1,)                 entries of point p are ``row[p]:row[p + 1]``
``nodes``                   (m,) int32               flat index of the entry's node, the offset of its field
                                                     included
``weight``, ``values``      (m,)                     φ_ip; in ``linear_weights`` (dim, 2), w_d of the two
                                                     nodes
``gradient``, ``gradients`` (m, dim) [1/m]           ∇φ_ip; of length 0 where it is not wanted
``spacing``                 dim numbers [m]          the cell size h, once for each dimension
``dt``                      [s]                      length of the step
``h``, ``inverse_h``        [m], [1/m]               cell size, and its inverse
``own_nodes``               2 integers               first node that is added to, and the one after the last;
                                                     None for all.
                                                     With them, the nodes of a row must ascend
``p``, ``k``                                         index of a point, of an entry in the table
``mass``                    (n,) or (N,) [kg/m]      m_p; in kernels on nodes alone m_i
``velocity``                (n, dim) or (N, dim)     v_p [m/s]; in kernels on nodes alone v_i
``momentum``                (N, dim) [kg/s]          (m v)_i
``force``                   (N, dim) [N/m]           f_i
``acceleration``            (dim,) [m/s^2]           body force per mass b
``position``                (n, dim) [m]             x_p; in the geometry surface nodes x_s
``affine``                  (n, dim, dim) [1/s]      C_p, or None
``moment``                  (n, dim, dim) [m^2/s]    B_p
``deformation_gradient``    (n, dim, dim)            F_p
``volume``                  (n,) [m^dim]             V_p
``stress``                  (n, dim, dim) [Pa]       σ_p, Cauchy, tension positive
``node_mass``               (N,) [kg/m]              m_i
``node_momentum``           (N, dim) [kg/s]          (m v)_i
``node_force``              (N, dim) [N/m]           f_i
``lower``                   (dim,) [m]               first node of the background grid; of boxes (B, dim)
``upper``                   (B, dim) [m]               upper corners of boxes
``window_lower``            (F, dim) int64           background index of the first node of a field's window
``window_shape``            (F, dim) int64           number of nodes of a field's window
``offset``                  (F + 1,) int64           flat index of the first node of a field's window
``origin``                  (dim,) [m]               position of the first node of one window
``shape``                   (dim,) int64             number of nodes of one window
``base``                    (dim,)                   index of the first node that a point touches, within its
                                                     window
``slope``                   (dim, width) [1/m]       derivatives of the weights; in ``fill_domain`` (2**dim,
                                                     dim), of corners
``share``                   (2**dim,) or (dim,)      weights of the corners of a particle's domain;
                                                     barycentric coordinates
``corner``                  (2**dim, dim)            the corners in cells, counted from the window's first
                                                     node
``x``, ``y``                [m]                      a point, (dim,); in ``segment_coordinate`` its
                                                     coordinates; along one axis
``x1``, ``y1``              [m]                      first end of a segment
``x2``, ``y2``              [m]                      second end of a segment
``surface``                                          facets (``mpmfw.kernels.Facets``)
``m``, ``s``                                         index of a facet, of a surface node
``facets``                  (n, dim) int64           surface nodes at the corners of every facet
``corners``                 (dim, dim) [m]           corners of a facet, one a row
``normal``                  (dim,)                   e_n
``rows``, ``old``                                    rows of contact (``mpmfw.kernels.contact.Rows``), of this
                                                     and the last step
``count``, ``old_count``                             number of rows in ``rows`` and ``old``
``o``, ``c``                                         a row of the last step, a row of this step
``vector``                  (n, dim)                 of rows of the last step
``stiffness``, ``scale``    (n,) [N/m^2], [1]        of a row; a factor
``records``                                          sums of every pair (``mpmfw.kernels.contact.Records``)
``node_sum``, ``out``                                scratch (N,); where the result is written
``first``, ``second``       (pair,) int64            bodies of every pair
``pair_of``, ``a``, ``b``                            table of ``mpmfw.kernels.contact.pair_table``, two
                                                     bodies
=========================== ======================== =========================================================
"""

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels._struct import Struct, struct
from mpmfw.kernels.arithmetic import add_scaled_row, determinant, invert, set_scaled_row
from mpmfw.kernels.boxes import bounding_boxes
from mpmfw.kernels.facets import closest_point, segment_coordinate, squared_distance
from mpmfw.kernels.particle_grid import (
    add_body_force,
    add_internal_force,
    affine_from_moment,
    integrate_momentum,
    project_mass_momentum,
    project_momentum,
    velocity_of_momentum,
)
from mpmfw.kernels.stencil import (
    FULL,
    OUTSIDE,
    cell_coordinate,
    entries,
    fill_domain,
    fill_linear,
    fill_tensor_product,
    fits,
    linear_weights,
    read_window,
)
from mpmfw.kernels.surfaces import Facets, minimum_gap, signed_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints

__all__ = [
    "FULL",
    "OUTSIDE",
    "Facets",
    "Float",
    "Floats",
    "Indices",
    "Ints",
    "Struct",
    "add_body_force",
    "add_internal_force",
    "add_scaled_row",
    "affine_from_moment",
    "bounding_boxes",
    "cell_coordinate",
    "closest_point",
    "determinant",
    "device",
    "entries",
    "fill_domain",
    "fill_linear",
    "fill_tensor_product",
    "fits",
    "integrate_momentum",
    "invert",
    "kernel",
    "linear_weights",
    "minimum_gap",
    "project_mass_momentum",
    "project_momentum",
    "read_window",
    "scratch",
    "segment_coordinate",
    "set_scaled_row",
    "signed_distance",
    "squared_distance",
    "struct",
    "velocity_of_momentum",
]
