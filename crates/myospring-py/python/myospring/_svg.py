"""Small drawings for notebooks."""

from __future__ import annotations

from typing import Any, Sequence

from numpy.typing import NDArray

_WIDTH = 480.0
_MARGIN = 12.0


def outline_svg(name: str, rings: Sequence[NDArray[Any]]) -> str:
    """Draws the outline of a cell (its rings in um) with a scale bar."""
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    extent = high - low
    scale = min((_WIDTH - 2 * _MARGIN) / extent[0], (_WIDTH - 2 * _MARGIN) / extent[1])
    height = scale * extent[1] + 2 * _MARGIN + 26

    def at(x: float, y: float) -> str:
        return f"{_MARGIN + scale * (x - low[0]):.1f},{_MARGIN + scale * (high[1] - y):.1f}"

    path = " ".join("M" + " L".join(at(x, y) for x, y in ring) + " Z" for ring in rings)
    bar = next(size for size in (100, 50, 20, 10, 5, 2, 1) if size <= extent.max() / 3 or size == 1)
    base = height - 10
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {_WIDTH:.0f} {height:.1f}" role="img" aria-label="{name}">'
        f'<path d="{path}" fill="#dbe7f3" stroke="#33597f" stroke-width="1.2" fill-rule="evenodd"/>'
        f'<path d="M{_MARGIN},{base:.1f} h{bar * scale:.1f}" stroke="currentColor" stroke-width="2"/>'
        f'<text x="{_MARGIN + bar * scale + 6:.1f}" y="{base + 4:.1f}" font-family="sans-serif" font-size="12" '
        f'fill="currentColor">{bar} um</text></svg>'
    )
