"""Detection between tracked surfaces: nodes of one body against facets of another."""

from mpmfw.contact.surfaces.detection import FacetOptions, OnFacets, Surfaces, SurfacesOptions

__all__ = ["FacetOptions", "OnFacets", "Surfaces", "SurfacesOptions"]
