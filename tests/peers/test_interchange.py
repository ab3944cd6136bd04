"""What `legwork convert` writes, read by others: pymavlink's waypoint loader, lxml and json; and the other way round."""

import csv
import io
import json
import subprocess
import zipfile

import pytest
from conftest import BIN, TOP
from lxml import etree
from pymavlink import mavwp

PLANS = ["square.xml", "coast-patrol.xml"]
WAYPOINT, TAKEOFF, LAND, CHANGE_SPEED = 16, 22, 21, 178


def legwork(*arguments, status=0):
    """Standard output of a command, which must end with this status."""
    command = [str(BIN / "legwork"), *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, timeout=300)
    assert result.returncode == status, result.stderr.decode(errors="replace")
    return result.stdout


def convert(tmp_path, plan, extension):
    written = tmp_path / f"written.{extension}"
    legwork("convert", TOP / "assets/plans" / plan, written)
    return written


@pytest.fixture(params=PLANS)
def plan(request):
    return request.param


def reference(plan):
    """Rows of the CSV, which every other format must agree with."""
    text = legwork("convert", TOP / "assets/plans" / plan, "-", "--to", "csv").decode()
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) > 3
    return [(float(r["latitude_deg"]), float(r["longitude_deg"]), float(r["altitude_amsl_m"]), r["action"]) for r in rows]


def agree(found, rows, degrees=1e-7):
    assert len(found) == len(rows)
    for (lat, lon, altitude), row in zip(found, rows):
        assert lat == pytest.approx(row[0], abs=degrees) and lon == pytest.approx(row[1], abs=degrees)
        assert altitude == pytest.approx(row[2], abs=0.1)


def test_pymavlink_loads_the_waypoint_list(plan, tmp_path):
    loader = mavwp.MAVWPLoader()
    count = loader.load(str(convert(tmp_path, plan, "waypoints")))
    items = [loader.wp(i) for i in range(count)]
    assert [i.seq for i in items] == list(range(count))
    # navigation commands have numbers below 95; the others (speed, camera) have no position
    home, moves = items[0], [i for i in items[1:] if i.command < 95]
    rows = reference(plan)
    # the loader keeps coordinates as MISSION_ITEM does: single precision
    agree([(i.x, i.y, i.z) for i in moves], rows, degrees=1e-5)
    commands = {"take-off": TAKEOFF, "fly": WAYPOINT, "land": LAND}
    assert [i.command for i in moves] == [commands[row[3]] for row in rows]
    assert home.command == WAYPOINT and abs(home.x - rows[0][0]) < 0.1
    assert any(i.command == CHANGE_SPEED and i.param2 > 0 for i in items)


def test_the_qgc_plan_has_the_same_waypoints(plan, tmp_path):
    file = json.loads(convert(tmp_path, plan, "plan").read_text())
    assert file["fileType"] == "Plan" and file["version"] == 1 and file["mission"]["version"] == 2
    items = []
    for item in file["mission"]["items"]:
        if item.get("complexItemType") == "fwLandingPattern":
            # the final approach and the touch-down; such a pattern has no numbers of its own
            for place in (item["landingApproachCoordinate"], item["landCoordinate"]):
                items.append({"doJumpId": len(items) + 1, "frame": 0, "params": [0.0] * 4 + place})
        else:
            items += item["TransectStyleComplexItem"]["Items"] if item["type"] == "ComplexItem" else [item]
    assert [i["doJumpId"] for i in items] == list(range(1, len(items) + 1))
    assert all(len(i["params"]) == 7 for i in items)
    agree([i["params"][4:] for i in items if i["frame"] == 0], reference(plan))


def test_gpx_kml_and_geojson_have_the_same_path(plan, tmp_path):
    rows = reference(plan)
    gpx = etree.parse(convert(tmp_path, plan, "gpx")).getroot()
    space = {"g": "http://www.topografix.com/GPX/1/1", "k": "http://www.opengis.net/kml/2.2"}
    points = gpx.findall("g:rte/g:rtept", space)
    agree([(float(p.get("lat")), float(p.get("lon")), float(p.findtext("g:ele", namespaces=space))) for p in points], rows)

    kml = etree.parse(convert(tmp_path, plan, "kml")).getroot()
    with zipfile.ZipFile(convert(tmp_path, plan, "kmz")) as packed:
        assert packed.testzip() is None
        assert etree.tostring(etree.fromstring(packed.read("doc.kml"))) == etree.tostring(kml)
    tuples = kml.findtext(".//k:LineString/k:coordinates", namespaces=space).split()
    numbers = [tuple(map(float, t.split(","))) for t in tuples]
    agree([(lat, lon, altitude) for lon, lat, altitude in numbers], rows)

    geojson = json.loads(convert(tmp_path, plan, "geojson").read_text())
    [path] = [f for f in geojson["features"] if f["properties"]["legwork"] == "path"]
    agree([(lat, lon, altitude) for lon, lat, altitude in path["geometry"]["coordinates"]], rows)


def test_a_mission_written_by_pymavlink_is_read(tmp_path):
    loader = mavwp.MAVWPLoader()
    square = [(36.3190, -84.1730, 349.0), (36.3273, -84.1598, 450.0), (36.3209, -84.1536, 450.0), (36.3053, -84.1782, 460.0)]
    for lat, lon, altitude in square:
        loader.add_latlonalt(lat, lon, altitude)
    mission, plan = tmp_path / "mission.waypoints", tmp_path / "mission.xml"
    loader.save(str(mission))
    legwork("convert", mission, plan)
    root = etree.parse(plan).getroot()
    space = {"p": "urn:legwork:flight-plan:1"}
    legs = root.findall(".//p:mainPlan/p:stage/*", space)
    assert [(float(leg.get("lat")), float(leg.get("lon"))) for leg in legs] == [
        pytest.approx(row[:2], abs=1e-5) for row in square[1:]
    ]


def test_an_alternate_is_written_alone(tmp_path):
    whole = legwork("convert", TOP / "assets/plans/square.xml", "-", "--to", "csv").decode().splitlines()
    alone = legwork("convert", TOP / "assets/plans/square.xml", "-", "--to", "csv", "--emergency", "return").decode().splitlines()
    legs = {line.split(",")[1] for line in alone[1:]}
    assert legs == {"r1", "r-land"} and len(alone) < len(whole)


def test_exit_statuses(tmp_path):
    square = TOP / "assets/plans/square.xml"
    written = tmp_path / "square.gpx"
    legwork("convert", square, written)
    legwork("convert", square, written, status=2)
    legwork("convert", square, written, "--force")
    legwork("convert", square, tmp_path / "strict.gpx", "--strict", status=1)
    legwork("convert", square, tmp_path / "square.dwg", status=2)
    legwork("diff", square, square)
    changed = tmp_path / "changed.xml"
    changed.write_text(square.read_text().replace('lat="36.305396"', 'lat="36.305400"'))
    report = json.loads(legwork("diff", square, changed, "--at", "side2", "--json", status=1))
    changed = {(change["part"], change["id"], change["fate"]) for change in report["changes"]}
    assert ("leg", "side3", "changed") in changed and ("fix", "C", "changed") in changed
    assert report["takeover"]["acceptable"] and report["takeover"]["next_leg"] == "side2"
    legwork("diff", square, tmp_path / "none.xml", status=2)
