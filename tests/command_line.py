"""The command line, called in this process."""

from typer.testing import CliRunner

from mpmfw.cli import app


def called(*arguments, status=0):
    """What ``mpmfw`` with ``arguments`` printed; it ends with ``status``."""
    done = CliRunner().invoke(app, [str(one) for one in arguments])
    assert done.exit_code == status, done.output
    return done
