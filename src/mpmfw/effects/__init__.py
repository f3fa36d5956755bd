"""Effects of the core that a scene may call for; each is imported and registered only if it does."""
