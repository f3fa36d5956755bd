"""A hook that its author wrote is called, or the class is refused: by its class, and wherever a run meets it."""

from __future__ import annotations

from typing import Any

import pytest

import mpmfw
from mpmfw.api import ContactStrategy, Grid, SceneError, hookimpl
from mpmfw.plugin.dead_hooks import refuse_dead_hooks
from scenes_for_tests import two_blocks


class Forgotten(ContactStrategy):
    """A hook without its mark."""

    name = "forgotten"

    def after_momentum_update(self, grid: Grid) -> None:
        """Never called."""
        grid.momentum[:] = 0.0


class Marked(ContactStrategy):
    """The same with its mark, a helper of any name, and an attribute that is called as a hook is."""

    name = "marked"
    advect = None

    @hookimpl
    def after_momentum_update(self, grid: Grid) -> None:
        """Called."""

    @hookimpl(specname="end_step")
    def count(self) -> None:
        """Called as another hook."""

    @hookimpl(optionalhook=True)
    def of_a_later_version(self) -> None:
        """Allowed to be unknown."""


class MarkLost(Marked):
    """A mark belongs to a method: the one that takes its place needs its own."""

    def after_momentum_update(self, grid: Grid) -> None:
        """Never called."""


class Unknown(ContactStrategy):
    """A mark on a name that is no hook's."""

    name = "unknown"

    @hookimpl
    def after_momentum_updat(self, grid: Grid) -> None:
        """Never called."""


class Asking(ContactStrategy):
    """An argument that the hook does not give."""

    name = "asking"

    @hookimpl
    def after_momentum_update(self, grid: Grid, particle: Any) -> None:
        """Cannot be called."""


class OldStyle(ContactStrategy):
    """A wrapper that pluggy would call itself."""

    name = "old-style"

    @hookimpl(hookwrapper=True)
    def after_momentum_update(self) -> Any:
        """Nothing before, and nothing after."""
        yield


class WithPart(ContactStrategy):
    """A law whose part has the fault."""

    name = "with-part"

    def parts(self) -> list[Any]:
        """The faulty one."""
        return [Forgotten()]


@pytest.mark.parametrize(
    ("plugin", "said"),
    [
        (
            Forgotten,
            r"test_dead_hooks\.Forgotten\.after_momentum_update has the name of a hook and is not marked",
        ),
        (
            MarkLost,
            r"test_dead_hooks\.MarkLost\.after_momentum_update has the name of a hook and is not marked",
        ),
        (
            Asking,
            r"Asking\.after_momentum_update asks for 'particle', which the hook does not give; did you mean 'particles'",
        ),
        (
            OldStyle,
            r"OldStyle\.after_momentum_update is a wrapper of the old style; expected @hookimpl\(wrapper=True\)",
        ),
        (Unknown, r"Unknown\.after_momentum_updat is marked .* did you mean 'after_momentum_update'\?"),
    ],
)
def test_a_hook_that_could_not_be_called_is_refused(plugin: type[Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        refuse_dead_hooks(plugin)
    with pytest.raises(SceneError, match=said):
        mpmfw.run(two_blocks("separate"), contact=plugin())


def test_a_part_of_a_law_is_asked_as_well() -> None:
    with pytest.raises(SceneError, match=r"Forgotten\.after_momentum_update has the name of a hook"):
        mpmfw.run(two_blocks("separate"), contact=WithPart())


def test_marks_and_helpers_that_are_in_order_pass() -> None:
    refuse_dead_hooks(Marked)


def test_a_law_without_a_name_is_refused_before_it_runs() -> None:
    class Nameless(ContactStrategy):
        """Nobody can call it."""

    with pytest.raises(SceneError, match=r"Nameless: expected a class attribute 'name'"):
        mpmfw.run(two_blocks("separate"), contact=Nameless())
