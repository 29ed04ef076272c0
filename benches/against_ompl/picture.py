"""The picture of a comparison: success and quality over CPU time as SVG, a column of panels for each coverage."""

import math
from xml.sax.saxutils import escape

# Colours of Okabe and Ito; ours are the two that stand out, with marks of their own.
STYLES = {
    "rrtconnect": ("RRTConnect", "#999999", "circle"),
    "rrtconnect-simplified": ("RRTConnect, simplified", "#000000", "circle"),
    "prmstar": ("PRM*, simplified", "#0072b2", "circle"),
    "rrtstar": ("RRT*, simplified", "#56b4e9", "circle"),
    "bitstar": ("BIT*, simplified", "#009e73", "circle"),
    "aitstar": ("AIT*, simplified", "#cc79a7", "circle"),
    "hybrid-astar": ("hybrid-astar", "#d55e00", "square"),
    "prm-rs": ("prm-rs", "#e69f00", "diamond"),
    "lattice": ("lattice", "#7a4b1e", "triangle"),
    "prm+primitives": ("prm+primitives", "#8b0a50", "wedge"),
}
CORNERS = {
    "square": [(-4, -4), (4, -4), (4, 4), (-4, 4)],
    "diamond": [(0, -6), (6, 0), (0, 6), (-6, 0)],
    "triangle": [(0, -6), (5.5, 4.5), (-5.5, 4.5)],
    "wedge": [(0, 6), (5.5, -4.5), (-5.5, -4.5)],
}
INK, FAINT = "#222222", "#dddddd"
LEFT, PANEL, GAP, TOP, HEIGHT, BETWEEN = 70, 370, 70, 56, 165, 58
LEGEND_COLUMNS, LEGEND_LINE = 5, 22
LOW_S, HIGH_S = 5e-5, 2.0
# A planner that reaches fewer has no quality that could be compared: its drives are the easy ones.
LEAST_SUCCESS = 0.9


class Scale:
    """From values to pixels, linear or logarithmic; what lies beyond an end is drawn on it."""

    def __init__(self, low, high, first, last, ticks, is_log=False):
        self.low, self.high, self.first, self.last, self.ticks, self.is_log = low, high, first, last, ticks, is_log

    def at(self, value):
        low, high, value = self.low, self.high, min(max(value, self.low), self.high)
        if self.is_log:
            low, high, value = math.log(low), math.log(high), math.log(value)
        return self.first + (value - low) / (high - low) * (self.last - self.first)


# What is drawn over CPU time: title, value, range and ticks.
PANELS = [
    ("success, %", lambda row: 100 * row.success, 0, 100, [0, 25, 50, 75, 100]),
    ("mean length over bound", lambda row: row.length_over_bound_mean, 1, 2, [1, 1.25, 1.5, 1.75, 2]),
    ("median clearance, m", lambda row: row.clearance_median_m, 0, 1.5, [0, 0.5, 1, 1.5]),
    ("mean number of cusps", lambda row: row.cusps_mean, 0, 6, [0, 2, 4, 6]),
]
NOTES = [
    "First four rows: planners of OMPL from the smallest budget to the largest, ours from little effort to much; building "
    "is not counted.",
    "Last row: OMPL at its largest budget, ours from little minimum clearance to much. A mark on an edge may lie beyond it.",
    f"Length, clearance and cusps are of the drives that were found, and shown where at least {LEAST_SUCCESS:.0%} were.",
]


def draw(rows):
    """The text of an SVG file."""
    coverages = sorted({row.coverage for row in rows})
    width = LEFT + len(coverages) * (PANEL + GAP)
    legend_top = TOP + (len(PANELS) + 1) * (HEIGHT + BETWEEN)
    height = legend_top + math.ceil(len(STYLES) / LEGEND_COLUMNS) * LEGEND_LINE + 76
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        'font-family="Helvetica, Arial, sans-serif" font-size="13">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for column, coverage in enumerate(coverages):
        left = LEFT + column * (PANEL + GAP)
        title = f"{100 * coverage:g} % of the cells under bushes"
        parts.append(text(left + PANEL / 2, 24, title, "middle", 'font-size="15"'))
        parts += draw_column([row for row in rows if row.coverage == coverage], left)
    for index, (name, (label, _, _)) in enumerate(STYLES.items()):
        x = 30 + index % LEGEND_COLUMNS * (width - 40) / LEGEND_COLUMNS
        y = legend_top + index // LEGEND_COLUMNS * LEGEND_LINE
        parts += draw_series(name, [(x, y), (x + 22, y)])
        parts.append(text(x + 32, y + 4, label))
    parts += [text(30, height - 52 + 18 * index, note, "start", 'font-size="12"') for index, note in enumerate(NOTES)]
    return "\n".join([*parts, "</svg>\n"])


def draw_column(rows, left):
    """All panels of a coverage, one below the other."""
    time = Scale(LOW_S, HIGH_S, left, left + PANEL, [1e-4, 1e-3, 1e-2, 1e-1, 1], is_log=True)
    top = TOP
    for title, value, low, high, ticks in PANELS:
        up = Scale(low, high, top + HEIGHT, top, ticks)
        yield from draw_frame(time, up, title, "mean CPU time of a query", in_time)
        for name in STYLES:
            drawn = [row for row in rows if row.planner == name and row.kind != "clearance"]
            if not title.startswith("success"):
                drawn = [row for row in drawn if row.success >= LEAST_SUCCESS]
            yield from draw_series(name, [(time.at(row.cpu_mean_s), up.at(value(row))) for row in drawn])
        top += HEIGHT + BETWEEN
    up = Scale(1, 1.6, top + HEIGHT, top, [1, 1.2, 1.4, 1.6])
    room = Scale(0, 1.5, left, left + PANEL, [0, 0.5, 1, 1.5])
    yield from draw_frame(room, up, "mean length over bound", "median clearance, m", "{:g}".format)
    for name in STYLES:
        front = on_the_front(rows, name)
        yield from draw_series(name, [(room.at(row.clearance_median_m), up.at(row.length_over_bound_mean)) for row in front])


def on_the_front(rows, name):
    """OMPL's planners where they have most time, ours by the clearance that they are to keep."""
    found = [row for row in rows if row.planner == name and row.success >= LEAST_SUCCESS]
    budgets = [row for row in found if row.kind == "budget"]
    clearances = [row for row in found if row.kind == "clearance"]
    return budgets[-1:] or clearances or found[:1]


def in_time(seconds):
    """Seconds in a unit that makes them short."""
    return f"{1e3 * seconds:g} ms" if seconds < 1 else f"{seconds:g} s"


def text(x, y, words, anchor="start", further=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{INK}" {further}>{escape(words)}</text>'


def line(x0, y0, x1, y1, colour):
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{colour}"/>'


def draw_frame(across, up, title, bottom, label):
    """Axes with ticks; the title of the upward axis is above it."""
    for tick in up.ticks:
        y = up.at(tick)
        yield line(across.first, y, across.last, y, FAINT)
        yield text(across.first - 6, y + 4, f"{tick:g}", "end")
    for tick in across.ticks:
        x = across.at(tick)
        yield line(x, up.first, x, up.last, FAINT)
        yield text(x, up.first + 16, label(tick), "middle")
    yield line(across.first, up.first, across.last, up.first, INK)
    yield line(across.first, up.first, across.first, up.last, INK)
    yield text(across.first, up.last - 11, title, "start", 'font-weight="bold"')
    yield text(across.last, up.first + 32, bottom, "end", 'font-size="12"')


def draw_series(name, points):
    """A line with a mark at every point."""
    _, colour, shape = STYLES[name]
    if len(points) > 1:
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        yield f'<polyline points="{way}" fill="none" stroke="{colour}" stroke-width="1.8"/>'
    for x, y in points:
        if shape == "circle":
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>'
        else:
            way = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in CORNERS[shape])
            yield f'<polygon points="{way}" fill="{colour}" stroke="white" stroke-width="0.7"/>'
