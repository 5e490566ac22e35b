"""How a paper prints a table or figure, as far as its text says so. Ours take words and colours
from it, and tests compare the rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from bezierplan.figures import style
from bezierplan.schema.model import Line, Model, Name, Setting, build_list_type, build_mapping_type

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Axis = Literal["x", "y", "z"]
Words = build_mapping_type(dict[Setting, Line], build_list_type(Line))


class Layout(Model):
    """The form of a table or figure in print."""

    says: Line = Field(description="what the paper's text says about it, in your own words")
    series: Words = Field(
        {},
        description="what a figure shows, in the printed order: name, value or entry of the "
        "legend → its printed name; or a list of these",
    )
    axes: dict[Axis, build_list_type(Line)] = Field(
        {}, description="x, y or z → what the axis shows, in all panels or in each"
    )
    units: dict[Axis, build_list_type(Line)] = Field({}, description="likewise its unit")
    looks: dict[Line, dict[Name, Setting]] = Field(
        {},
        description="entry of the legend → its properties of matplotlib in the paper, such as "
        "color; red, blue and black are the colours of all our figures",
    )
    heads: dict[Name, str] = Field(
        {}, description="column of the runs table → the printed head of a table, or an empty one"
    )
    rows: Words = Field(
        {}, description="rows of a table, in the printed order: name → its printed name; or a list"
    )
    words: dict[Name, Line] = Field({}, description="other names of a table, likewise")
    form: dict[Name, Any] = Field(
        {}, description="the rest of its form, which tests compare: panels, kind, columns, ..."
    )
    conditions: dict[Name, Any] = Field(
        {}, description="what the paper says about its runs, which tests compare with ours"
    )

    @property
    def names(self) -> dict[Any, str]:
        """Return printed names in their order.

        A blank one becomes a space, because pandas would name an empty one.
        """
        parts = (self.heads, self.rows, self.words, self.series)
        every = [part if isinstance(part, dict) else dict(zip(part, part)) for part in parts]
        return {name: printed or " " for part in every for name, printed in part.items()}

    def apply_to(self, axes: Axes, number: int) -> None:
        """Give a panel's axes and artists the words and colours of print.

        number: the panel's, from 0. Units stay those of the drawn data.
        """
        for name, given in self.axes.items():
            own = getattr(axes, f"get_{name}label")()
            unit = own[own.rfind(" (") :] if own.endswith(")") else ""
            axes.set(**{f"{name}label": given[min(number, len(given) - 1)] + unit})
        for artist in axes.get_children():
            look = self.looks.get(artist.get_label(), {})
            artist.set(**{key: style.COLOURS.get(value, value) for key, value in look.items()})
