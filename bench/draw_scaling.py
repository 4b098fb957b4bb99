# SPDX-License-Identifier: MIT
"""Draws the first table of bench_scaling, read from standard input, as an SVG: nanoseconds per
triangle of builds and refits on one thread against the number of triangles."""

import math
import sys

WIDTH, HEIGHT, LEFT, TOP = 560, 300, 60, 20
CURVES = (("build, binned_sah", 3, "#1f5fa8"), ("build, fast", 5, "#c25a00"), ("refit", 7, "#2a7d3f"))


def rows():
    for line in sys.stdin:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 10 and cells[0].isdigit() and cells[1] == "1":
            yield [float(cell) for cell in cells]


def main():
    table = list(rows())
    x_min, x_max = math.log10(table[0][0]), math.log10(table[-1][0])
    most = max(row[column] for row in table for _, column, _ in CURVES)
    step = 10.0 ** math.floor(math.log10(most)) / 2.0
    top = math.ceil(most / step) * step

    def x(triangles):
        return LEFT + (math.log10(triangles) - x_min) / (x_max - x_min) * (WIDTH - LEFT - 130)

    def y(nanoseconds):
        return TOP + (1.0 - nanoseconds / top) * (HEIGHT - TOP - 45)

    print(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
          'font-family="sans-serif" font-size="12">')
    print(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    for i in range(round(top / step) + 1):
        value = i * step
        print(f'<path d="M{LEFT} {y(value):.1f}H{x(10 ** x_max):.1f}" stroke="#ddd"/>'
              f'<text x="{LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>')
    last = -math.inf
    for row in table:
        if x(row[0]) - last > 50:
            last = x(row[0])
            print(f'<text x="{last:.1f}" y="{HEIGHT - 26}" text-anchor="middle">{row[0]:.0e}</text>')
    print(f'<text x="{(LEFT + x(10 ** x_max)) / 2:.0f}" y="{HEIGHT - 8}" text-anchor="middle">'
          'triangles</text>')
    print(f'<text x="14" y="{HEIGHT / 2 - 10:.0f}" text-anchor="middle" '
          f'transform="rotate(-90 14 {HEIGHT / 2 - 10:.0f})">ns per triangle</text>')
    for name, column, colour in CURVES:
        points = " ".join(f"{x(row[0]):.1f},{y(row[column]):.1f}" for row in table)
        print(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        print(f'<text x="{x(table[-1][0]) + 8:.1f}" y="{y(table[-1][column]) + 4:.1f}" '
              f'fill="{colour}">{name}</text>')
    print("</svg>")


if __name__ == "__main__":
    main()
