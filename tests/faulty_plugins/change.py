"""Plant a fault in a sound plug-in: the class as it is, but for a text of its source."""

import inspect
import sys
import textwrap


def fault(base, name, *changes):
    """Return ``base`` under another name, with changes: a method, a text that it has once, and another text.

    A text of several lines is indented as its place is.
    """
    texts = {}
    for method, old, new in zip(changes[::3], changes[1::3], changes[2::3], strict=True):
        text = texts.get(method) or source_of(base, method)
        assert text.count(old) == 1, f"{name}: '{old}' is {text.count(old)} times in {method}"
        line = next(line for line in text.splitlines() if old.splitlines()[0] in line)
        indent = line[: len(line) - len(line.lstrip())]
        texts[method] = text.replace(old, new.replace("\n", f"\n{indent}"))
    kind = "" if "model_fields" not in dir(base) else f'type: Literal["{name}"] = "{name}"'
    body = textwrap.indent("\n".join([kind, *texts.values()]), "    ")
    names = {**vars(sys.modules[base.__module__]), "base": base}
    exec(f"class {name}(base):\n{body}", names)
    return names[name]


def source_of(base, method):
    """Return the source of a method or property; what it calls of its base stays that of its base."""
    found = inspect.getattr_static(base, method)
    source = textwrap.dedent(inspect.getsource(getattr(found, "fget", found)))
    return source.replace("super()", "super(base, self)")
