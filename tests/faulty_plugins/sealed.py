"""What plug-ins with a fault share: a name, and what cannot be sent to another process."""


class Named:
    """Names a plug-in with a fault as its class is called."""

    def __init_subclass__(cls, **keywords):
        """Set the name that a subclass does not give itself."""
        super().__init_subclass__(**keywords)
        if "name" not in vars(cls):
            cls.name = cls.__name__


class Sealed:
    """Holds a function that was made on the way."""

    def __init__(self, **options):
        super().__init__(**options)
        self.made = lambda: self
