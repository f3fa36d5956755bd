#!/usr/bin/env -S uv run --script

# /// script
# dependencies = ["nox>=2025.10.14"]
# ///
"""The scripts of CI by name: ``nox`` runs them all, ``nox -s lowest`` one, ``nox --list`` names them."""

from __future__ import annotations

import nox

nox.needs_version = ">=2025.10.14"
nox.options.default_venv_backend = "uv|virtualenv"


@nox.session(venv_backend="none")
def run(session: nox.Session) -> None:
    """Tests, validation, linters, types, directions of import, documentation, templates: on a fresh copy."""
    session.run(".ci/run", external=True)


@nox.session(venv_backend="none")
def lowest(session: nox.Session) -> None:
    """Tests with the lowest versions allowed; arguments after ``--`` go to pytest."""
    session.run(".ci/lowest", *session.posargs, external=True)


@nox.session(venv_backend="none")
def templates(session: nox.Session) -> None:
    """Both templates from wheels, beside mpmfw's wheel."""
    session.run(".ci/templates", external=True)


@nox.session
def docs(session: nox.Session) -> None:
    """The documentation site, into build/site."""
    session.install(".[docs]")
    session.run(".ci/docs", "build/site", external=True)


@nox.session(default=False)
def review(session: nox.Session) -> None:
    """What sp-repo-review says of the repository."""
    session.install("sp-repo-review[cli]>=2026.8")
    session.run("sp-repo-review", ".")


if __name__ == "__main__":
    nox.main()
