"""Work that takes long is shown on a terminal from a second on, and Ctrl-C ends it at once."""

import os
import pty
import select
import signal
import subprocess
import time

from conftest import BIN

LEGS = 499_000


def plan(path):
    """A plan as long as one may be, none of whose legs can be flown as it is written."""
    legs = "".join(
        f'<TF id="l{i}" lat="{36 + i // 500 * 0.003:.4f}" lon="{-84 + i % 500 * 0.001:.4f}"/>' for i in range(LEGS)
    )
    path.write_text(
        '<flightPlan xmlns="urn:legwork:flight-plan:1" name="long" aircraft="trainer"><mainPlan><stage id="s" '
        f'type="mission" altitude="1200" altitudeReference="amsl">{legs}</stage></mainPlan></flightPlan>'
    )
    return path


def test_a_long_check_shows_that_it_goes_on_and_ends_at_ctrl_c(tmp_path):
    own, terminal = pty.openpty()
    command = [BIN / "legwork", "check", plan(tmp_path / "long.xml")]
    begun = time.monotonic()
    environment = {**os.environ, "TERM": "xterm"}
    check = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=terminal,
        env=environment,
        start_new_session=True,
        # who runs the tests in the background has the shell ignore it for all of them
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    os.close(terminal)
    shown = b""
    while b"checking the plan" not in shown and check.poll() is None and time.monotonic() < begun + 30:
        if select.select([own], [], [], 0.5)[0]:
            shown += os.read(own, 4096)
    assert b"checking the plan" in shown, shown
    assert 0.9 < time.monotonic() - begun < 5, "from a second on"
    asked = time.monotonic()
    check.send_signal(signal.SIGINT)
    assert check.wait(10) == -signal.SIGINT
    assert time.monotonic() - asked < 1
    os.close(own)
