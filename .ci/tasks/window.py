"""Legwork's window with a mouse and a keyboard: xdotool, so that what is tried is the window as people have it."""

import os
import pathlib
import re
import signal
import subprocess
from typing import Optional

from screen import BUTTON, CHOICE, COMBO, TEXT, Screen, Thing, wait_for

Place = tuple[int, int]
# of the window
SIZE = (1280, 1000)


def xdotool(*arguments: object) -> None:
    subprocess.run(["xdotool", *map(str, arguments)], check=True)


class Window:
    """A window with its plan's file, in a home of its own."""

    def __init__(self, program: str, home: pathlib.Path, *arguments: object) -> None:
        self.program, self.home = program, home
        self.gestures = 0
        self.screen = Screen()
        self.open(*arguments)

    def open(self, *arguments: object) -> None:
        """Opens it, and gives it the keyboard."""
        environment = {**os.environ, "HOME": str(self.home)}
        with open(self.home / "window.log", "ab") as log:
            self.process = subprocess.Popen(
                [self.program, *map(str, arguments)], env=environment, stderr=log, start_new_session=True
            )
        wait_for("the window", self._is_open, lambda: (self.home / "window.log").read_text(encoding="utf-8"))
        search = ["search", "--sync", "--onlyvisible", "--name", "Legwork"]
        xdotool(*search, "windowsize", *SIZE, "windowfocus", "--sync")
        wait_for("the size of the window", lambda: self.find("Push").left > SIZE[0] - 100)
        if self.screen.all("Skip the tour"):
            self.click("Skip the tour")

    def _is_open(self) -> bool:
        if self.process.poll() is not None:
            raise AssertionError((self.home / "window.log").read_text(encoding="utf-8"))
        return bool(self.screen.all("Map"))

    def kill(self) -> None:
        """Ends it as a power cut does."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        wait_for("the end of the window", lambda: not self.screen.things())

    # what is seen

    def find(self, name: str, role: Optional[int] = None, which: int = 0) -> Thing:
        return self.screen.find(name, role, which)

    def shows(self, part: str) -> bool:
        """Whether a part of a name is anywhere."""
        return any(part in thing.name for thing in self.screen.things())

    def wait_until_shown(self, part: str) -> None:
        wait_for(f"{part!r} in the window", lambda: self.shows(part), lambda: self.told())

    def told(self) -> str:
        return "\n".join(str(thing) for thing in self.screen.things())

    def picture(self, file: pathlib.Path) -> None:
        subprocess.run(["import", "-window", "root", str(file)], check=True)

    # hands

    def click_at(self, at: Place, button: int = 1) -> None:
        self.gestures += 1
        xdotool("mousemove", *at, "sleep", 0.1, "click", button, "sleep", 0.2)

    def click(self, name: str, role: Optional[int] = None, which: int = 0, button: int = 1) -> None:
        self.click_at(self.find(name, role, which).middle, button)

    def click_map(self, *from_middle: Place) -> None:
        """Clicks places of the map, from its middle."""
        middle = self.find("Map").middle
        for right, down in from_middle:
            self.click_at((middle[0] + right, middle[1] + down))

    def drag(self, start: Place, by: Place) -> None:
        self.gestures += 1
        half = (start[0] + by[0] // 2, start[1] + by[1] // 2)
        end = (start[0] + by[0], start[1] + by[1])
        xdotool("mousemove", *start, "sleep", 0.2, "mousedown", 1, "sleep", 0.2)
        xdotool("mousemove", *half, "sleep", 0.2, "mousemove", *end, "sleep", 0.3, "mouseup", 1, "sleep", 0.2)

    def hold(self, name: str, until: str, which: int = 0) -> None:
        """Keeps a button pressed until something is shown."""
        self.gestures += 1
        xdotool("mousemove", *self.find(name, BUTTON, which).middle, "sleep", 0.1, "mousedown", 1)
        try:
            self.wait_until_shown(until)
        finally:
            xdotool("mouseup", 1)

    def press(self, *keys: str) -> None:
        for key in keys:
            self.gestures += 1
            xdotool("key", key, "sleep", 0.2)

    def write(self, text: str) -> None:
        self.gestures += 1
        xdotool("type", "--delay", 20, text)

    def fill_in(self, role: int, name: str, text: str) -> None:
        """Writes into a field, in the place of what is there."""
        self.click(name, role)
        xdotool("key", "ctrl+a")
        self.write(text)
        xdotool("key", "Return", "sleep", 0.2)

    def choose(self, combo: str, option: str) -> None:
        """Takes an option of a list."""
        self.click(combo, COMBO)
        self.click(option, CHOICE, which=-1)

    def row_menu(self, row: str, entry: str) -> None:
        """Takes an entry of the menu of a row of the plan."""
        self.click(row, button=3)
        self.click(entry)

    def ask_for(self, letters: str, command: str) -> None:
        """Finds a command in the palette by a few letters, and takes it."""
        self.press("ctrl+k")
        self.find("Search commands")
        self.write(letters)
        self.find(command)
        self.press("Return")

    def paste(self, text: str) -> None:
        """Has a text on the clipboard, as another program copies it, and pastes it."""
        subprocess.run(["xclip", "-selection", "clipboard"], input=text.encode(), check=True, stdout=subprocess.DEVNULL)
        self.press("ctrl+v")

    # the file

    def save(self, file: pathlib.Path, *expected: str) -> str:
        """Saves the plan into the file it has, and waits until that has what is expected of it (patterns)."""
        self.press("ctrl+s")
        return written(file, *expected)

    def save_as(self, file: pathlib.Path, *expected: str) -> str:
        """Saves a plan that has no file yet."""
        self.press("ctrl+s")
        self.fill_in(TEXT, "File name", str(file))
        return written(file, *expected)


def written(file: pathlib.Path, *expected: str) -> str:
    """The text of a file, as soon as all of these patterns are in it."""
    def text() -> str:
        return file.read_text(encoding="utf-8") if file.exists() else ""

    def is_all() -> bool:
        return bool(text()) and all(re.search(pattern, text()) for pattern in expected)

    wait_for(f"{expected} in {file}", is_all, text)
    return text()
