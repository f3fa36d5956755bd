"""``python -m mpmfw``: the commands, of the environment of this Python whatever else is on the path."""

from mpmfw.cli import main

if __name__ == "__main__":
    main()
