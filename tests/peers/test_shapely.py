"""Shapely (GEOS): the same survey pattern by the library that planners are usually written with, as oracle and peer."""

import json
import math
import random
import subprocess
import time

import pytest
from conftest import BIN
from shapely import LineString, MultiLineString, Polygon, prepare, union_all
from shapely.affinity import rotate

# of the tests' build: what it times, the geometry, is optimised there, too
SURVEY = BIN / "examples/survey"


def star(seed, corners, holed):
    """A concave area around the origin, with a smaller one of its shape for a hole."""
    rng = random.Random(seed)
    radii = [rng.uniform(400, 3000) for _ in range(corners)]

    def ring(share):
        angle = 2 * math.pi / corners
        return [(share * r * math.cos(i * angle), share * r * math.sin(i * angle)) for i, r in enumerate(radii)]

    return Polygon(ring(1.0), [ring(0.4)] if holed else [])


def ours(area, spacing, heading, overshoot):
    """The scanning pieces, and the seconds they took."""
    order = {
        "outer": list(area.exterior.coords),
        "holes": [list(hole.coords) for hole in area.interiors],
        "spacing_m": spacing,
        "heading_deg": heading,
        "overshoot_m": overshoot,
    }
    run = subprocess.run([SURVEY], input=json.dumps(order), capture_output=True, text=True, check=True)
    survey = json.loads(run.stdout)
    return [LineString([line[:2], line[2:]]) for line in survey["scanning"]], survey["seconds"]


def theirs(area, spacing, heading):
    """Lines spread evenly, as few as are no more than a spacing apart, the outer ones half of that inside the edges; clipped one by one:
    what a planner does with shapely."""
    started = time.perf_counter()
    # headings are clockwise from north, shapely's angles anticlockwise: turned by the heading, the lines run north
    turned = rotate(area, heading, origin=(0, 0))
    west, south, east, north = turned.bounds
    prepare(turned)
    pieces = []
    count = math.ceil((east - west) / spacing - 1e-9)
    for i in range(count):
        across = west + (i + 0.5) * (east - west) / count
        pieces.append(turned.intersection(LineString([(across, south - 1), (across, north + 1)])))
    seconds = time.perf_counter() - started
    return rotate(union_all(pieces), -heading, origin=(0, 0)), seconds


CASES = [(seed, corners, holed) for seed, corners in enumerate((3, 5, 8, 12, 40, 100)) for holed in (False, True)]


@pytest.mark.parametrize("seed, corners, holed", CASES)
def test_the_same_lines_are_scanned(seed, corners, holed):
    area, heading = star(seed, corners, holed), 17.0 * seed
    lines, _ = ours(area, 50, heading, 0)
    expected, _ = theirs(area, 50, heading)
    assert sum(line.length for line in lines) == pytest.approx(expected.length, rel=1e-6)
    # each of ours lies on one of theirs
    assert MultiLineString(lines).difference(expected.buffer(0.001)).length < 0.01


@pytest.mark.parametrize("seed, corners, holed", CASES)
def test_everything_is_covered_and_nothing_is_beyond_the_overshoot(seed, corners, holed):
    area, heading, spacing = star(seed, corners, holed), 31.0 * seed, 80
    lines, _ = ours(area, spacing, heading, spacing / 2)
    # GEOS rounds with chords, which lie inside the circle
    seen = union_all([line.buffer(spacing / 2, quad_segs=64) for line in lines])
    assert area.intersection(seen).area / area.area > 0.9999
    outside = MultiLineString(lines).difference(area.buffer(spacing / 2 + 0.1, quad_segs=64))
    assert outside.length < 0.01


def test_the_time_both_take(capsys):
    """Printed, not asserted: machines differ."""
    area = star(7, 100, False)
    spacing = rotate(area, 0).bounds[2] - rotate(area, 0).bounds[0]
    spacing /= 10_000
    lines, our_seconds = ours(area, spacing, 0, 0)
    expected, their_seconds = theirs(area, spacing, 0)
    assert sum(line.length for line in lines) == pytest.approx(expected.length, rel=1e-6)
    with capsys.disabled():
        ratio = their_seconds / our_seconds
        print(
            f"\n10,000 survey lines over 100 corners, {len(lines)} pieces: ours {1000 * our_seconds:.2f} ms, "
            f"shapely {1000 * their_seconds:.0f} ms ({ratio:.0f} times)"
        )
