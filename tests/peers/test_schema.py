"""xmllint, an outside validator, against the schema and every example."""

import subprocess

import pytest
from conftest import TOP

SCHEMA = TOP / "assets/schema/flight-plan-1.xsd"
DOCS = TOP / "assets/docs"
# the first step of the tutorial is an empty plan, which the schema does not allow
LESSONS = [*DOCS.glob("fragments/*.xml"), *(set(DOCS.glob("tutorial/*.xml")) - {DOCS / "tutorial/step-01.xml"})]
DATA = TOP / "shared/flight-plan/tests/data"
GOOD = sorted([*(TOP / "assets/plans").glob("*.xml"), *LESSONS]) + [DATA / "language.xml", DATA / "any-order.xml"]
GOOD += sorted((TOP / "shared/flight-exec/tests/authored").glob("*.xml"))
BAD = sorted((TOP / "assets/plans/bad").glob("*.xml"))
# faults of meaning, which a schema cannot see, are for the product's own checks
SCHEMA_SEES = [path for path in BAD if path.name.startswith("xsd-")]


def validate(path):
    command = ["xmllint", "--noout", "--nonet", "--schema", SCHEMA, path]
    return subprocess.run(command, capture_output=True, text=True, errors="replace")


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.name)
def test_a_good_example_is_valid(path):
    result = validate(path)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("path", SCHEMA_SEES, ids=lambda path: path.name)
def test_a_bad_example_is_rejected(path):
    assert validate(path).returncode != 0


def test_there_are_examples():
    assert len(GOOD) >= 40 and len(SCHEMA_SEES) >= 3
