"""Public names that are imported when they are first asked for: a plan needs only the planner."""

from collections.abc import Callable, Mapping
from importlib import import_module


def lazy_names(
    package: str, homes: Mapping[str, str]
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Make the ``__getattr__`` and ``__dir__`` of a package that re-exports names.

    Parameters
    ----------
    package
        Its name.
    homes
        Each public name with the module inside the package that it comes from.

    Examples
    --------
    >>> look_up, names = lazy_names("explicable", {"Agent": "model.team"})
    >>> look_up("Agent").__module__, names()
    ('explicable.model.team', ['Agent'])
    """

    def look_up(name: str) -> object:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{homes[name]}"), name)

    return look_up, lambda: sorted(homes)
