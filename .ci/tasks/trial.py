"""One task: its folder, its window, and what is looked at when it is done."""

import pathlib
import re
import subprocess
import time
from typing import Optional

from screen import wait_for
from window import Window, written

PLANS = pathlib.Path(__file__).resolve().parents[2] / "assets" / "plans"


class Trial:
    """What a task is given. A picture of the window is left in its folder, however it ends."""

    def __init__(self, programs: pathlib.Path, home: pathlib.Path) -> None:
        self.programs, self.home = programs, home
        self.file = home / "plan.xml"
        self.window: Optional[Window] = None
        self._began = time.monotonic()
        self._others: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> "Trial":
        return self

    def __exit__(self, *_: object) -> None:
        if self.window and self.window.process.poll() is None:
            self.window.picture(self.home / "window.png")
            self.window.kill()
        for other in reversed(list(self._others)):
            self.end(other)

    @property
    def gestures(self) -> int:
        return self.window.gestures if self.window else 0

    @property
    def seconds(self) -> float:
        """Since it began."""
        return time.monotonic() - self._began

    def open(self, *arguments: object) -> Window:
        """A window with these arguments."""
        self.window = Window(str(self.programs / "legwork"), self.home, *arguments)
        return self.window

    def open_square(self, *faults: tuple[str, str]) -> Window:
        """A window with the smallest of the example plans, after these replacements."""
        text = (PLANS / "square.xml").read_text(encoding="utf-8")
        for right, wrong in faults:
            text = text.replace(right, wrong)
        self.file.write_text(text, encoding="utf-8")
        return self.open(self.file)

    def begin(self, program: str, *arguments: object) -> None:
        """Another program beside the window; what it says goes into the folder."""
        with open(self.home / f"{program}.log", "wb") as log:
            command = [str(self.programs / program), *map(str, arguments)]
            begun = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=subprocess.STDOUT)
        self._others[program] = begun

    def said_by(self, program: str, what: str) -> str:
        """The first part of a pattern, as soon as the program beside the window has said that."""
        text = written(self.home / f"{program}.log", what)
        return re.findall(what, text)[0]

    def end(self, program: str) -> None:
        """Asks a program to end until it does: in flight the agent wants to be asked twice."""
        other = self._others.pop(program)

        def has_ended() -> bool:
            other.terminate()
            return other.poll() is not None

        wait_for(f"the end of {program}", has_ended)

    def ask(self, *arguments: object) -> str:
        """What `legwork` says to that; it must not fail."""
        command = [str(self.programs / "legwork"), *map(str, arguments)]
        asked = subprocess.run(command, capture_output=True, text=True, check=False)
        assert asked.returncode == 0, f"{command}: {asked.stdout}{asked.stderr}"
        return asked.stdout

    def can_be_flown(self) -> None:
        """What was saved has no error."""
        self.ask("check", self.file)
