# SPDX-License-Identifier: MIT
"""Charts as SVG, both axes logarithmic."""

import dataclasses
import math
from xml.sax.saxutils import escape

COLOURS = ["#0b6e99", "#d1495b", "#2e933c", "#e58f1e", "#6f4a8e", "#6b705c", "#00a6a6", "#8c5a2b", "#c06c9e", "#444444"]
WIDTH, HEIGHT = 760, 480
LEFT, RIGHT, TOP, BOTTOM = 80, 190, 40, 60


@dataclasses.dataclass
class Line:
    name: str
    points: list  # of (x, y), both greater than 0
    colour: int = 0
    dashed: bool = False


class Axis:
    """From a range of values to pixels; `begin` may be greater than `end`."""

    def __init__(self, values, begin, end):
        low, high = math.log10(min(values)), math.log10(max(values))
        margin = max(0.05 * (high - low), 0.1)
        self.low, self.high, self.begin, self.end = low - margin, high + margin, begin, end

    def at(self, value):
        return self.begin + (math.log10(value) - self.low) / (self.high - self.low) * (self.end - self.begin)

    def ticks(self):
        """1, 2 and 5 times powers of ten, or the powers alone where there are many."""
        steps = (1,) if self.high - self.low > 3 else (1, 2, 5)
        exponents = range(math.floor(self.low), math.ceil(self.high) + 1)
        return [step * 10**e for e in exponents for step in steps if self.low <= math.log10(step) + e <= self.high]


def text(x, y, words, **attributes):
    written = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in attributes.items())
    return f'<text x="{x:.1f}" y="{y:.1f}"{written}>{escape(words)}</text>'


def stroke(x0, y0, x1, y1, colour):
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{colour}"/>'


def framed(title, body):
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12">',
                      f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
                      text(LEFT, TOP - 16, title, font_size=15), *body, "</svg>"]) + "\n"


def grid(x, y, x_label, y_label):
    body = []
    for value in x.ticks():
        body += [stroke(x.at(value), TOP, x.at(value), HEIGHT - BOTTOM, "#e0e0e0"),
                 text(x.at(value), HEIGHT - BOTTOM + 18, f"{value:g}", text_anchor="middle")]
    for value in y.ticks() if y else []:
        body += [stroke(LEFT, y.at(value), WIDTH - RIGHT, y.at(value), "#e0e0e0"),
                 text(LEFT - 8, y.at(value) + 4, f"{value:g}", text_anchor="end")]
    body.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - BOTTOM + 42, x_label, text_anchor="middle"))
    middle = (TOP + HEIGHT - BOTTOM) / 2
    body.append(text(22, middle, y_label, text_anchor="middle", transform=f"rotate(-90 22 {middle})"))
    return body


def line_chart(title, x_label, y_label, lines):
    lines = [line for line in lines if line.points]
    x = Axis([point[0] for line in lines for point in line.points], LEFT, WIDTH - RIGHT)
    y = Axis([point[1] for line in lines for point in line.points], HEIGHT - BOTTOM, TOP)
    body = grid(x, y, x_label, y_label)
    for row, line in enumerate(lines):
        colour, dashes = COLOURS[line.colour % len(COLOURS)], ' stroke-dasharray="6 4"' if line.dashed else ""
        places = [(x.at(a), y.at(b)) for a, b in sorted(line.points)]
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in places)
        body.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"{dashes}/>')
        body += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{colour}"/>' for a, b in places]
        level = TOP + 10 + 20 * row
        legend = WIDTH - RIGHT + 14
        body.append(f'<line x1="{legend}" y1="{level}" x2="{legend + 26}" y2="{level}" stroke="{colour}" stroke-width="2"{dashes}/>')
        body.append(text(legend + 32, level + 4, line.name))
    return framed(title, body)


def range_chart(title, x_label, rows):
    """Of each (name, least, median, greatest) a range with its median as a dot; a line at 1."""
    x = Axis([1] + [value for row in rows for value in row[1:]], 2 * LEFT, WIDTH - RIGHT)
    body = grid(x, None, x_label, "") + [stroke(x.at(1), TOP, x.at(1), HEIGHT - BOTTOM, "#404040")]
    step = (HEIGHT - TOP - BOTTOM) / len(rows)
    for i, (name, least, median, greatest) in enumerate(rows):
        level = TOP + (i + 0.5) * step
        body += [text(2 * LEFT - 10, level + 4, name, text_anchor="end"),
                 f'<line x1="{x.at(least):.1f}" y1="{level:.1f}" x2="{x.at(greatest):.1f}" y2="{level:.1f}" stroke="{COLOURS[0]}" stroke-width="3"/>',
                 f'<circle cx="{x.at(median):.1f}" cy="{level:.1f}" r="5" fill="{COLOURS[0]}"/>',
                 text(max(x.at(greatest), x.at(1)) + 10, level + 4, f"{median:.2f}")]
    return framed(title, body)
