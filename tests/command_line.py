"""The command line, called in this process."""

from typer.testing import CliRunner

from mpmfw.cli import app


def called(*arguments, status=0):
    """Run ``mpmfw`` with ``arguments``, check its ``status``, and return what it printed."""
    done = CliRunner().invoke(app, [str(one) for one in arguments])
    assert done.exit_code == status, done.output
    return done
