"""Pictures that show themselves in a notebook."""


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
