"""Files as other programs' own writers make them: pymavlink, gpxpy, fastkml and geojson write, and a writer after DroneKit's documents;
`legwork convert` reads them, tells what it assumed or lost, and writes what they meant again."""

import json
import subprocess

import fastkml
import geojson
import gpxpy.gpx
import pygeoif
import pytest
from conftest import BIN
from lxml import etree
from pymavlink import mavutil, mavwp
from test_interchange import legwork

SPACE = {"p": "urn:legwork:flight-plan:1"}
SQUARE = [(36.3273, -84.1598, 470.0), (36.3209, -84.1437, 475.0), (36.3053, -84.1582, 480.0), (36.3105, -84.1760, 470.0)]
FENCE = [(36.28, -84.21), (36.35, -84.21), (36.35, -84.12), (36.28, -84.12)]
# 1e-7 degrees are 0.011 m in latitude, and less in longitude
NEAR = 0.9e-7


def imported(file, tmp_path, *options):
    """What a file becomes, as XML."""
    plan = tmp_path / "imported.xml"
    legwork("convert", file, plan, *options)
    return etree.parse(plan).getroot()


def legs(root):
    found = root.findall(".//p:mainPlan/p:stage/*", SPACE)
    return [(float(leg.get("lat")), float(leg.get("lon")), float(leg.get("altitude"))) for leg in found]


def agree(found, rows, degrees=NEAR):
    assert len(found) == len(rows)
    for (lat, lon, altitude), row in zip(found, rows):
        assert lat == pytest.approx(row[0], abs=degrees) and lon == pytest.approx(row[1], abs=degrees)
        assert altitude == pytest.approx(row[2], abs=0.01)


def notes(source, target):
    """The codes of what a conversion tells."""
    command = [str(BIN / "legwork"), "convert", "--json", "--force", str(source), str(target)]
    result = subprocess.run(command, capture_output=True, timeout=300)
    assert result.returncode == 0, result.stderr.decode(errors="replace")
    return sorted(note["code"] for note in json.loads(result.stderr)["notes"])


def comes_back(file, tmp_path, extension, assumed=(), lost=("speeds-not-carried",)):
    """It may be flown, and what is exported again has the same waypoints, before those of a final approach. The codes are those of the
    notes that import and export must have, no others."""
    plan, again = tmp_path / "checked.xml", tmp_path / f"again.{extension}"
    assert notes(file, plan) == sorted(["aircraft-assumed", *assumed])
    legwork("check", plan)
    assert notes(plan, again) == sorted(lost)
    agree(legs(imported(again, tmp_path, "--force"))[: len(SQUARE)], SQUARE)


def test_gpxpy_writes_a_route_and_waypoints(tmp_path):
    gpx = gpxpy.gpx.GPX()
    route = gpxpy.gpx.GPXRoute(name="Square")
    route.points = [gpxpy.gpx.GPXRoutePoint(lat, lon, elevation=altitude) for lat, lon, altitude in SQUARE]
    gpx.routes.append(route)
    gpx.waypoints.append(gpxpy.gpx.GPXWaypoint(36.319, -84.173, name="Camp"))
    file = tmp_path / "square.gpx"
    file.write_text(gpx.to_xml())
    root = imported(file, tmp_path)
    agree(legs(root), SQUARE)
    assert [fix.get("id") for fix in root.iterfind(".//p:fixes/p:fix", SPACE)] == ["Camp"]
    comes_back(file, tmp_path, "gpx")


def test_gpxpy_writes_a_track_that_stood_still(tmp_path):
    gpx = gpxpy.gpx.GPX()
    segment = gpxpy.gpx.GPXTrackSegment()
    segment.points = [gpxpy.gpx.GPXTrackPoint(lat, lon, elevation=altitude) for lat, lon, altitude in SQUARE for _ in range(3)]
    gpx.tracks.append(gpxpy.gpx.GPXTrack(name="Ride"))
    gpx.tracks[0].segments.append(segment)
    file = tmp_path / "ride.gpx"
    file.write_text(gpx.to_xml(version="1.0"))
    agree(legs(imported(file, tmp_path)), SQUARE)


def test_fastkml_writes_a_path_and_an_area(tmp_path):
    path = fastkml.Placemark(
        name="Square",
        kml_geometry=fastkml.geometry.LineString(
            geometry=pygeoif.LineString([(lon, lat, altitude) for lat, lon, altitude in SQUARE]),
            altitude_mode=fastkml.enums.AltitudeMode.absolute,
        ),
    )
    file = tmp_path / "square.kml"
    file.write_text(fastkml.KML(features=[fastkml.Document(name="Places", features=[path])]).to_string(precision=9))
    agree(legs(imported(file, tmp_path)), SQUARE)
    comes_back(file, tmp_path, "kml")
    base = fastkml.Placemark(name="Base", geometry=pygeoif.Polygon([(lon, lat) for lat, lon in FENCE]))
    # a part of a file, without <kml> around it
    for feature in (base, fastkml.Document(features=[base])):
        part = tmp_path / "part.kml"
        part.write_text(feature.to_string())
        root = imported(part, tmp_path, "--areas", "keep-out", "--force")
        assert len(root.findall(".//p:zones/p:keepOut/p:corner", SPACE)) == len(FENCE)


def test_geojson_writes_lines_areas_and_nothing(tmp_path):
    line = geojson.LineString([(lon, lat, altitude) for lat, lon, altitude in SQUARE], precision=9)
    file = tmp_path / "square.geojson"
    file.write_text(geojson.dumps(geojson.FeatureCollection([geojson.Feature(geometry=line, properties={"name": "Square"})])))
    agree(legs(imported(file, tmp_path)), SQUARE)
    comes_back(file, tmp_path, "geojson", ["ellipsoid"])
    far = tmp_path / "far.geojson"
    far.write_text(geojson.dumps(geojson.LineString([(179.9, -16.8, 300), (180.1, -16.8, 300)])))
    assert [leg[1] for leg in legs(imported(far, tmp_path, "--force"))] == [pytest.approx(179.9), pytest.approx(-179.9)]
    ring = [(lon, lat) for lat, lon in FENCE]
    area = tmp_path / "area.geojson"
    # as the rows of a bounding box
    area.write_text(geojson.dumps(geojson.Polygon([[ring[0], ring[1], ring[3], ring[2], ring[0]]])))
    plan = tmp_path / "area.xml"
    legwork("convert", area, plan, "--areas", "keep-in")
    problems = json.loads(legwork("check", "--json", plan, status=1))["problems"]
    assert any(p["code"] == "bad-zone" and p["fix"] for p in problems)
    empty = tmp_path / "empty.geojson"
    empty.write_text(geojson.dumps(geojson.FeatureCollection([])))
    legwork("convert", empty, tmp_path / "empty.xml", status=1)
    assert not (tmp_path / "empty.xml").exists()


def item(sequence, command, *params, place=(0.0, 0.0, 0.0), frame=3):
    """A mission item of the wire."""
    params = [*params, 0.0, 0.0, 0.0, 0.0][:4]
    return mavutil.mavlink.MAVLink_mission_item_message(1, 1, sequence, frame, command, 0, 1, *params, *place)


def home_and_square(add):
    """Home, take-off, the square above home, and a return to launch."""
    add(16, place=(36.319, -84.173, 349.0), frame=0)
    add(22, place=(36.319, -84.173, 60.0))
    for lat, lon, altitude in SQUARE:
        add(16, place=(lat, lon, altitude - 349.0))
    add(20)


# what both lists leave open: how a return to launch ends, and the runway of each direction
ASSUMED = ["return-to-launch", "runway-made-up", "runway-made-up"]
ABOVE_HOME = [(lat, lon, altitude - 349.0) for lat, lon, altitude in SQUARE]


def test_pymavlink_writes_a_mission(tmp_path):
    mission = mavwp.MAVWPLoader()
    home_and_square(lambda command, **where: mission.add(item(mission.count(), command, **where)))
    file = tmp_path / "mission.txt"
    mission.save(str(file))
    agree(legs(imported(file, tmp_path)), ABOVE_HOME)
    comes_back(file, tmp_path, "waypoints", ASSUMED, ["runway-not-carried"] * 2)


def test_dronekit_like_writer_saves_a_mission(tmp_path):
    """As the export of DroneKit's guide ("Example: Mission Import/Export") has it: the home position and the vehicle's commands, each
    value as Python shows it, behind one another with tabs."""
    rows = []

    def add(command, place=(0, 0, 0), frame=3):
        rows.append([len(rows), int(not rows), frame, command, 0.0, 0.0, 0.0, 0.0, *place, 1])

    home_and_square(add)
    file = tmp_path / "saved_mission.txt"
    file.write_text("QGC WPL 110\n" + "".join("\t".join(map(str, row)) + "\n" for row in rows))
    agree(legs(imported(file, tmp_path)), ABOVE_HOME)
    comes_back(file, tmp_path, "waypoints", ASSUMED, ["runway-not-carried"] * 2)


def test_pymavlink_writes_loops_fences_and_rally_points(tmp_path):
    mission = mavwp.MAVWPLoader()
    mission.add(item(0, 16, place=(36.319, -84.173, 349.0), frame=0))
    for lat, lon, altitude in SQUARE:
        mission.add(item(mission.count(), 16, place=(lat, lon, altitude - 349.0)))
    mission.add(item(mission.count(), 177, 1, -1))
    file = tmp_path / "mission.txt"
    mission.save(str(file))
    assert notes(file, tmp_path / "noted.xml") == ["aircraft-assumed", "endless-jump"]
    [loop] = imported(file, tmp_path).findall(".//p:mainPlan/p:stage/p:iterative", SPACE)
    assert loop.get("count") is None and "battery" in loop.get("until") and len(loop) == len(SQUARE)

    fences = mavwp.MAVWPLoader()
    for index, (lat, lon) in enumerate(FENCE):
        fences.add(item(index, 5001, len(FENCE), place=(lat, lon, 0.0)))
    fences.save(str(file))
    root = imported(file, tmp_path, "--force")
    assert len(root.findall(".//p:zones/p:keepIn/p:corner", SPACE)) == len(FENCE)
    assert notes(file, tmp_path / "noted.xml") == ["aircraft-assumed"]

    points = mavwp.MAVFenceLoader()
    for lat, lon in [(36.319, -84.173), *FENCE, FENCE[0]]:
        points.add_latlon(lat, lon)
    points.save(str(file))
    root = imported(file, tmp_path, "--force")
    assert len(root.findall(".//p:zones/p:keepIn/p:corner", SPACE)) == len(FENCE)
    assert notes(file, tmp_path / "noted.xml") == ["aircraft-assumed", "breach-return"]

    rally = mavwp.MAVRallyLoader()
    rally.create_and_append_rally_point(36.319e7, -84.173e7, 100, 40, 5200, 0)
    rally.save(str(file))
    [runway] = imported(file, tmp_path, "--force").findall(".//p:runways/p:runway", SPACE)
    assert float(runway.get("lat")) == pytest.approx(36.319, abs=1e-5)
    assert notes(file, tmp_path / "noted.xml") == ["aircraft-assumed", "rally-as-runway", "rally-break-off", "runway-made-up"]
