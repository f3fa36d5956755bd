"""A plug-in that cannot be sent to another process."""


class Sealed:
    """Holds a function that was made on the way."""

    def __init__(self, **options):
        super().__init__(**options)
        self.made = lambda: self
