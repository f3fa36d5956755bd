"""The bundled adapters to other codes."""
