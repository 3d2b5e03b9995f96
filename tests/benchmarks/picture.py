#!/usr/bin/env python3
"""Draws README's picture: error against time of a robot's quantities, of generated code and its peers.

usage: picture.py [--robot MAHRU] [--page docs/performance.md] [--output docs/error_time.svg]

Figures are those of the page's table of times, "time ± spread, error" in each cell; run it when table.py has written the page.
"""

import argparse
import math
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
QUANTITIES = {"M": "M", "bias": "C v + g", "fd": "v̇"}
COLOURS = {"dalembert": "#c0392b", "mujoco": "#2471a3", "pinocchio": "#1e8449", "dart": "#b9770e", "kdl": "#7d3c98", "generic": "#839192"}
NAMES = {"dalembert": "dalembert", "mujoco": "MuJoCo", "pinocchio": "Pinocchio", "dart": "DART", "kdl": "KDL",
         "generic": "the generic engine here"}
UNITS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3}
CELL = re.compile(r"([\d.e+]+) (ns|µs|ms) ± [\d.]+ ?%, ([\d.e+-]+)")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 400, 90, 45, 50, 60


def points(page, robot):
    """(contestant, quantity, seconds, error) of the robot's table."""
    section = re.search(rf"^#+ {robot}\b.*?$(.*?)(?=^#|\Z)", page, re.MULTILINE | re.DOTALL)
    if not section:
        raise SystemExit(f"no section of {robot}")
    found, heads = [], None
    for line in section[1].splitlines():
        if not line.startswith("|"):
            heads = None
        elif heads is None:
            heads = [cell.strip() for cell in line.strip().strip("|").split("|")]
        else:
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            for head, cell in zip(heads[1:], cells[1:]):
                figure = CELL.search(cell)
                if figure and cells[0] in QUANTITIES and head in COLOURS:
                    found.append((head, cells[0], float(figure[1]) * UNITS[figure[2]], float(figure[3])))
    if not found:
        raise SystemExit(f"no figures of {robot}")
    return found


def ticks(low, high):
    return range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)


def time_text(power):
    return {-8: "10 ns", -7: "100 ns", -6: "1 µs", -5: "10 µs", -4: "100 µs", -3: "1 ms"}.get(power, f"1e{power} s")


def picture(found, robot):
    across, up = ticks(min(p[2] for p in found), max(p[2] for p in found)), ticks(min(p[3] for p in found), max(p[3] for p in found))

    def x(seconds):
        return LEFT + (math.log10(seconds) - across[0]) / (across[-1] - across[0]) * (WIDTH - LEFT - RIGHT)

    def y(error):
        return HEIGHT - BOTTOM - (math.log10(error) - up[0]) / (up[-1] - up[0]) * (HEIGHT - TOP - BOTTOM)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
           f"<title>Error against time of {robot}: down and to the left is better</title>",
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>']
    for power in across:
        at = x(10.0**power)
        out.append(f'<path d="M{at:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle" fill="#555">{time_text(power)}</text>')
    for power in up:
        at = y(10.0**power)
        out.append(f'<path d="M{LEFT} {at:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end" fill="#555">1e{power}</text>')
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 14}" text-anchor="middle">time of one call of {robot}</text>'
               f'<text transform="translate(22 {HEIGHT / 2}) rotate(-90)" text-anchor="middle">largest error, relative</text>')
    at = LEFT
    for who in COLOURS:
        if not any(p[0] == who for p in found):
            continue
        out.append(f'<circle cx="{at + 6}" cy="24" r="6" fill="{COLOURS[who]}"/><text x="{at + 17}" y="28.5">{NAMES[who]}</text>')
        at += 40 + 7.2 * len(NAMES[who])
    for who, quantity, seconds, error in found:
        out.append(f'<circle cx="{x(seconds):.1f}" cy="{y(error):.1f}" r="5" fill="{COLOURS[who]}"/>'
                   f'<text x="{x(seconds) + 8:.1f}" y="{y(error) + 4:.1f}" fill="{COLOURS[who]}">{QUANTITIES[quantity]}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="MAHRU")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs/performance.md")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "docs/error_time.svg")
    options = parser.parse_args()
    options.output.write_text(picture(points(options.page.read_text(encoding="utf-8"), options.robot), options.robot), encoding="utf-8")


main()
