"""The hook specifications, and their binding to plain calls."""

from types import SimpleNamespace

import pytest

from mpmfw.api import hookimpl
from mpmfw.errors import SceneError
from mpmfw.plugin.hooks import BoundHooks, Observer, Registry, pluggy_manager
from mpmfw.step import timestep as module
from mpmfw.step.timestep import Clock


def plugin(name, **hooks):
    """An object called ``name`` with the given hook implementations."""
    return type(name, (), {"name": name, **{key: staticmethod(value) for key, value in hooks.items()}})()


def bound(*plugins, clock=None):
    """The bound hooks of some plug-ins registered in turn, and pluggy's own."""
    registry, manager = Registry(), pluggy_manager()
    for one in plugins:
        registry.register(one, one.name)
        manager.register(one, name=one.name)
    return BoundHooks(registry, clock or Clock()), manager.hook


def answer(value, **options):
    """An implementation of ``stable_timestep`` that answers with ``value``."""

    @hookimpl(**options)
    def stable_timestep():
        return value

    return stable_timestep


def test_calls_come_in_the_order_of_pluggy():
    hook, pluggy_hook = bound(
        plugin("a", stable_timestep=answer("a")),
        plugin("last", stable_timestep=answer("last", trylast=True)),
        plugin("very last", stable_timestep=answer("very last", trylast=True)),
        plugin("first", stable_timestep=answer("first", tryfirst=True)),
        plugin("very first", stable_timestep=answer("very first", tryfirst=True)),
        plugin("b", stable_timestep=answer("b")),
        plugin("nothing", stable_timestep=answer(None)),
    )
    found = hook.stable_timestep(state=None)
    assert found == pluggy_hook.stable_timestep(state=None)
    assert found == ["very first", "first", "b", "a", "last", "very last"]


def test_an_observer_sees_every_implementation_while_it_runs():
    seen = []

    class Look(Observer):
        name = "look"
        observes = ("add_nodal_force",)

        def before(self, hook, plugin, grid, dt):  # noqa: ARG002
            seen.append(("before", hook, getattr(plugin, "name", None)))

        def after(self, hook, plugin, grid, dt):  # noqa: ARG002
            seen.append(("after", hook, getattr(plugin, "name", None)))

    @hookimpl
    def add_nodal_force():
        seen.append(("acts", "add_nodal_force", "load"))

    look = Look()
    hook, _ = bound(look, plugin("load", add_nodal_force=add_nodal_force))
    hook.add_nodal_force(grid=None, state=None, phi=None, dt=0.1)
    assert [when for when, _, _ in seen] == ["acts"]
    seen.clear()
    look.running = True
    hook.add_nodal_force(grid=None, state=None, phi=None, dt=0.1)
    assert [(when, who) for when, _, who in seen] == [
        ("before", None), ("before", "load"), ("acts", "load"), ("after", "load"), ("after", None),
    ]  # fmt: skip
    seen.clear()
    look.moments = {"add_nodal_force": ("begin", "after")}
    hook, _ = bound(look, plugin("load", add_nodal_force=add_nodal_force))
    hook.add_nodal_force(grid=None, state=None, phi=None, dt=0.1)
    assert [(when, who) for when, _, who in seen] == [("before", None), ("acts", "load"), ("after", "load")]


def test_first_result_stops_at_the_first_answer():
    called = []

    def reach(name, value):
        return hookimpl(lambda particles: called.append(name) or value)  # noqa: ARG005

    named = [("c", 3), ("b", 2), ("a", None)]
    hook, pluggy_hook = bound(*(plugin(name, particle_reach=reach(name, value)) for name, value in named))
    assert hook.particle_reach(particles=None) == pluggy_hook.particle_reach(particles=None) == 2
    assert called == ["a", "b"] * 2


def test_time_goes_to_the_stage_of_the_plug_in_and_back():
    clock, stages = Clock(), []

    @hookimpl
    def advect():
        stages.append(clock("contact"))

    @hookimpl
    def end_step():
        raise ValueError("in a plug-in")

    staged = plugin("a", advect=advect, end_step=end_step)
    staged.stage = "contact"
    hook, _ = bound(staged, clock=clock)
    clock("gather")
    hook.advect(grid=None, dt=0.1)
    assert stages == ["contact"]
    assert clock("gather") == "gather"
    with pytest.raises(SceneError, match=r"plug-in 'a' .* failed in end_step: ValueError: in a plug-in"):
        hook.end_step(state=None)
    assert clock("gather") == "gather"


def test_hooks_of_other_versions_may_be_optional():
    """And a plug-in's properties are not looked at, which may fail before the run."""

    class Later:
        @property
        def step(self):
            raise RuntimeError("not before the run")

        @hookimpl(optionalhook=True)
        def after_the_run(self, anything): ...

    registry = Registry()
    registry.register(Later(), "later")
    assert not any(registry.implementations.values())


@pytest.mark.parametrize("kind", ["wrapper", "hookwrapper"])
def test_a_wrapper_is_refused_by_any_name(kind):
    @hookimpl(**{kind: True}, specname="stable_timestep")
    def limit():
        yield

    with pytest.raises(SceneError, match="limit is a wrapper; expected a plain @hookimpl"):
        bound(plugin("old", limit=limit))


@pytest.fixture
def now(monkeypatch):
    """Wall and CPU seconds that the test sets."""
    now = SimpleNamespace(wall=100.0, cpu=10.0)
    fake = SimpleNamespace(perf_counter=lambda: now.wall, process_time=lambda: now.cpu)
    monkeypatch.setattr(module, "time", fake)
    return now


def test_cpu_time_is_shared_out_by_wall_time(now):
    clock = Clock()
    clock("shape")
    now.wall += 1.0
    clock("force")
    now.wall, now.cpu = now.wall + 3.0, now.cpu + 8.0
    clock.flush()
    assert (clock.cpu["shape"], clock.cpu["force"]) == (2.0, 6.0)


def test_seconds_of_compilation_count_in_no_stage(now):
    clock = Clock()
    clock("shape")
    now.wall, now.cpu = now.wall + 1.0, now.cpu + 1.0
    clock.on_start(None)
    clock.on_start(None)  # an inner kernel
    clock.on_end(None)
    now.wall, now.cpu = now.wall + 9.0, now.cpu + 9.0
    clock.on_end(None)
    clock.flush()
    assert (sum(clock.wall.values()), sum(clock.cpu.values())) == (1.0, 1.0)
    assert clock.compile_time == 9.0
