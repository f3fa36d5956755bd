"""Detection between tracked surfaces: nodes of one body against facets of another."""

from mpmfw.contact.surfaces.detection import FacetOptions, Surfaces, SurfacesOptions

__all__ = ["FacetOptions", "Surfaces", "SurfacesOptions"]
