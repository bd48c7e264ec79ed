#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the front half of surfaces side by side as SVG; triangles that face away are red: they are folded over.

Usage: scripts/surface-svg.py OUT.svg A.off [B.off ...]     seen along +x; OFF is written by hfremesh convert.
docs/pictures/folded-cylinder.svg comes from:
  hfremesh generate cylinder --n 6 16 --wring 90 -o c.mesh
  hfremesh c.mesh -o free.mesh --surface free --hausdorff 0.03
  hfremesh convert c.mesh -o c.off; hfremesh convert free.mesh -o free.off
  scripts/surface-svg.py docs/pictures/folded-cylinder.svg c.off free.off
docs/pictures/folded-wall.svg comes from:
  bench/folded_walls.py --write .
  hfremesh body-0.3.mesh -o open.mesh --surface flat
  hfremesh convert body-0.3.mesh -o a.off; hfremesh convert open.mesh -o b.off
  scripts/surface-svg.py docs/pictures/folded-wall.svg a.off b.off
"""
import sys

SIZE = 300  # of the longer side of a surface, in pixels


def read_off(path):
    words = open(path).read().split()
    n_points, n_faces = int(words[1]), int(words[2])
    values = words[4:]
    points = [tuple(map(float, values[3 * i : 3 * i + 3])) for i in range(n_points)]
    rest = list(map(int, values[3 * n_points :]))
    return points, [tuple(rest[4 * i + 1 : 4 * i + 4]) for i in range(n_faces)]


def paths(points, triangles, shift):
    low = [min(p[d] for p in points) for d in range(3)]
    high = [max(p[d] for p in points) for d in range(3)]
    scale = SIZE / max(high[1] - low[1], high[2] - low[2])

    def place(p):  # y goes to the left, seen from -x
        return (high[1] - p[1]) * scale + shift, (high[2] - p[2]) * scale

    front, back = [], []
    middle = 0.5 * (low[0] + high[0])
    for t in triangles:
        if sum(points[v][0] for v in t) / 3 > middle:
            continue
        (ax, ay), (bx, by), (cx, cy) = corners = [place(points[v]) for v in t]
        turned = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if turned >= 0 and sum(points[v][0] for v in t) / 3 > 0.5 * (low[0] + middle):
            continue  # the rim of what is seen
        text = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners) + "Z"
        (front if turned < 0 else back).append(text)
    return front, back, (high[1] - low[1]) * scale, (high[2] - low[2]) * scale


def main():
    out, files = sys.argv[1], sys.argv[2:]
    gap, x, height, body = 30, 10.0, 0.0, []
    for name in files:
        front, back, width, tall = paths(*read_off(name), x)
        body.append(f'<path fill="#dde3ea" stroke="#456" stroke-width=".6" d="{"".join(front)}"/>')
        if back:
            body.append(f'<path fill="#e33" fill-opacity=".7" stroke="#800" stroke-width=".6" d="{"".join(back)}"/>')
        x += width + gap
        height = max(height, tall)
    with open(out, "w") as f:
        f.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -10 {x - gap + 10:.0f} {height + 20:.0f}">')
        f.write('<rect y="-10" width="100%" height="100%" fill="#fff"/>\n' + "\n".join(body) + "\n</svg>\n")


if __name__ == "__main__":
    main()
