"""Makes ``tests`` importable: small factories live in ``support``."""
