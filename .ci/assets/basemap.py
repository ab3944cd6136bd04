#!/usr/bin/env python3
"""Makes assets/basemap/world.lwbm from the npm package world-atlas (Natural Earth as TopoJSON).

Run `.ci/assets/make`, which provides mapbox_earcut and the pinned package.

The file is what the map layer draws fastest: land as triangles, borders as polylines, country names with their
place, at two levels of detail. All integers are LEB128 varints, signed ones zigzag, positions in 1/1000 degree
(longitude, latitude), each relative to the one before it:

    "LWBM" version=1 levels { detail lands { rings { points {lon lat} } triangles { corner corner corner } } lines { points {..} } }
    labels { lon lat rank length utf8 }

`{ }` repeats as often as the number before it says; `detail` is the usual distance between vertices in 1/1000
degree; the corners of triangles count through all rings of their land; the lower the rank, the greater the country.
"""

import json
import sys

import mapbox_earcut
import numpy as np

UNIT = 1000


def arcs_of(topology):
    """Arcs as lists of integer positions in 1/UNIT degree, without repeated points."""
    (kx, ky), (dx, dy) = topology["transform"]["scale"], topology["transform"]["translate"]
    arcs = []
    for arc in topology["arcs"]:
        x = y = 0
        points = []
        for step in arc:
            x, y = x + step[0], y + step[1]
            point = (round((x * kx + dx) * UNIT), round((y * ky + dy) * UNIT))
            if not points or points[-1] != point:
                points.append(point)
        arcs.append(points)
    return arcs


def ring_of(arcs, indices):
    """A ring (closing point left out) from arc indices; ~i is arc i backwards."""
    points = []
    for i in indices:
        arc = arcs[i] if i >= 0 else arcs[~i][::-1]
        points.extend(p for k, p in enumerate(arc) if k or not points)
    points = [p for k, p in enumerate(points) if k == 0 or p != points[k - 1]]
    return points[:-1] if points and points[0] == points[-1] else points


def polygons_of(geometry):
    if geometry["type"] == "GeometryCollection":
        return [p for g in geometry["geometries"] for p in polygons_of(g)]
    return {"Polygon": [geometry.get("arcs")], "MultiPolygon": geometry.get("arcs")}.get(geometry["type"], [])


def unwrapped(ring):
    """The ring with continuous longitudes; one that goes round a pole is closed along it."""
    points = [ring[0]]
    for x, y in ring[1:]:
        turns = round((points[-1][0] - x) / (360 * UNIT))
        points.append((x + turns * 360 * UNIT, y))
    if abs(points[-1][0] - points[0][0]) > 180 * UNIT:
        pole = -90 * UNIT if points[0][1] < 0 else 90 * UNIT
        points += [(points[0][0] + round((points[-1][0] - points[0][0]) / (360 * UNIT)) * 360 * UNIT, points[0][1])]
        points += [(points[-1][0], pole), (points[0][0], pole)]
    return points


def clipped(ring, limit, keep_less):
    """The part of a ring on one side of a longitude (Sutherland and Hodgman)."""
    result = []
    for a, b in zip(ring, ring[1:] + ring[:1]):
        inside = [(p[0] <= limit) if keep_less else (p[0] >= limit) for p in (a, b)]
        if inside[0]:
            result.append(a)
        if inside[0] != inside[1] and a[0] != b[0]:
            result.append((limit, round(a[1] + (b[1] - a[1]) * (limit - a[0]) / (b[0] - a[0]))))
    return [p for k, p in enumerate(result) if p != result[k - 1]]


def pieces_of(ring):
    """The ring cut at the antimeridian, every piece within -180..180 degrees."""
    points, half = unwrapped(ring), 180 * UNIT
    pieces = []
    for k in (-1, 0, 1):
        piece = clipped(clipped(points, (2 * k + 1) * half, True), (2 * k - 1) * half, False)
        pieces.append([(x - 2 * k * half, y) for x, y in piece])
    return [p for p in pieces if len(p) >= 3 and area(p) > 0]


def rings_of(arcs, polygon):
    """Lands of a polygon: each an outer ring and its holes."""
    outer, *holes = [pieces_of(ring_of(arcs, ring)) for ring in polygon]
    lands = [[ring] for ring in outer]
    for hole in (h for pieces in holes for h in pieces):
        mine = [land for land in lands if within(hole, land[0])]
        if mine:
            mine[0].append(hole)
    return lands


def within(hole, ring):
    a, b = np.array(hole), np.array(ring)
    return bool((a.min(axis=0) >= b.min(axis=0)).all() and (a.max(axis=0) <= b.max(axis=0)).all())


def area(ring):
    a = np.array(ring, dtype=float)
    x, y = a[:, 0] * np.cos(np.radians(a[:, 1].mean() / UNIT)), a[:, 1]
    return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def triangles_of(rings):
    vertices = np.array([p for ring in rings for p in ring], dtype=np.float32)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    return mapbox_earcut.triangulate_float32(vertices, ends)


def borders_of(topology, arcs):
    """Arcs that two countries share."""
    used = {}
    for country in topology["objects"]["countries"]["geometries"]:
        for i in {j if j >= 0 else ~j for p in polygons_of(country) for ring in p for j in ring}:
            used[i] = used.get(i, 0) + 1
    return [arcs[i] for i, n in sorted(used.items()) if n > 1 and len(arcs[i]) > 1]


def label_place(ring):
    """The point of a coarse raster farthest from the ring's edges (inside by crossings)."""
    a = np.array(ring, dtype=float)
    (x0, y0), (x1, y1) = a.min(axis=0), a.max(axis=0)
    b = np.roll(a, -1, axis=0)
    best, best_distance = tuple(a.mean(axis=0)), -1.0
    for x in np.linspace(x0, x1, 24)[1:-1]:
        for y in np.linspace(y0, y1, 24)[1:-1]:
            crosses = (a[:, 1] > y) != (b[:, 1] > y)
            with np.errstate(divide="ignore", invalid="ignore"):
                at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
            if not np.count_nonzero(crosses & (at > x)) % 2:
                continue
            distance = np.min(np.hypot(a[:, 0] - x, (a[:, 1] - y) * 2))
            if distance > best_distance:
                best, best_distance = (x, y), distance
    return round(best[0]), round(best[1])


def varint(out, value):
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    out.append(value)


def signed(out, value):
    varint(out, value << 1 if value >= 0 else (-value << 1) - 1)


def points(out, line):
    varint(out, len(line))
    x = y = 0
    for px, py in line:
        signed(out, px - x)
        signed(out, py - y)
        x, y = px, py


def level(out, topology):
    arcs = arcs_of(topology)
    lands = [land for p in polygons_of(topology["objects"]["land"]) for land in rings_of(arcs, p)]
    lands.sort(key=lambda rings: -area(rings[0]))
    edges = [np.hypot(*np.diff(np.array(ring, dtype=float), axis=0).T) for rings in lands for ring in rings]
    varint(out, round(float(np.median(np.concatenate(edges)))))
    varint(out, len(lands))
    for rings in lands:
        varint(out, len(rings))
        for ring in rings:
            points(out, ring)
        corners = triangles_of(rings)
        varint(out, len(corners) // 3)
        for corner in corners:
            varint(out, int(corner))
    lines = borders_of(topology, arcs)
    varint(out, len(lines))
    for line in lines:
        points(out, line)


def labels(out, topology):
    arcs = arcs_of(topology)
    found = []
    for country in topology["objects"]["countries"]["geometries"]:
        rings = [land[0] for p in polygons_of(country) for land in rings_of(arcs, p)]
        if rings:
            biggest = max(rings, key=area)
            found.append((sum(map(area, rings)), country["properties"]["name"], label_place(biggest)))
    found.sort(key=lambda f: (-f[0], f[1]))
    varint(out, len(found))
    for rank, (_, name, (x, y)) in enumerate(found):
        signed(out, x)
        signed(out, y)
        varint(out, rank)
        text = name.encode()
        varint(out, len(text))
        out.extend(text)


def main(folder, output):
    coarse, fine = (json.load(open(f"{folder}/countries-{d}m.json")) for d in (110, 50))
    out = bytearray(b"LWBM")
    varint(out, 1)
    varint(out, 2)
    level(out, coarse)
    level(out, fine)
    labels(out, fine)
    with open(output, "wb") as file:
        file.write(out)
    print(f"{output}: {len(out)} bytes")


main(*sys.argv[1:])
