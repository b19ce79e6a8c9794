"""Pictures that show themselves in a notebook, and things that show themselves as pictures."""

from functools import singledispatch


class Drawing(str):
    """An SVG element: text like any other, which a notebook shows as the picture that it is.

    Examples
    --------
    >>> Drawing("<svg/>")._repr_svg_()
    '<svg/>'
    """

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return str(self)


@singledispatch
def draw(thing: object) -> str:
    """Draw a thing; the module that knows how registers it here, so that the thing need not know that module.

    Raises
    ------
    NotImplementedError
        If nobody has registered how, which notebooks take for "no picture".

    Examples
    --------
    >>> class Lamp(Drawn):
    ...     pass
    >>> _ = draw.register(Lamp, lambda lamp: "<svg/>")
    >>> Lamp()._repr_svg_()
    '<svg/>'
    """
    raise NotImplementedError(f"nothing draws a {type(thing).__name__}")


class Drawn:
    """A thing that a notebook shows as `draw` draws it."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return draw(self)
