"""Effects of the core; each is imported and registered only if the scene needs it."""
