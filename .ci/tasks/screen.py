"""What is on the screen, as a screen reader is told it: names, roles and places of everything in the window.

This is what makes the tasks independent of the machine's speed and of the place where something stands: a button is waited for
by its name, and clicked where it is. It needs a session bus (dbus-run-session) with at-spi2-core, and python3-dbus.
"""

import time
from typing import Callable, NamedTuple, Optional

import dbus
import dbus.bus

PATIENCE_S = 60
ACCESSIBLE = "org.a11y.atspi.Accessible"

# numbers that AT-SPI has for roles
BUTTON, CHOICE, COMBO, LABEL, NUMBER, ROW, TEXT, TICK = 43, 62, 11, 29, 52, 91, 79, 7


class Thing(NamedTuple):
    """Something with a name."""

    name: str
    role: int
    left: int
    top: int
    width: int
    height: int

    @property
    def middle(self) -> tuple[int, int]:
        return self.left + self.width // 2, self.top + self.height // 2


class Screen:
    """All windows of this session. Has to be made before they are opened: a program tells nobody who doesn't listen."""

    def __init__(self) -> None:
        launcher = dbus.SessionBus().get_object("org.a11y.Bus", "/org/a11y/bus")
        launcher.Set("org.a11y.Status", "IsEnabled", True, dbus_interface=dbus.PROPERTIES_IFACE)
        self._bus = dbus.bus.BusConnection(launcher.GetAddress(dbus_interface="org.a11y.Bus"))
        self._root = ("org.a11y.atspi.Registry", "/org/a11y/atspi/accessible/root")

    def _ask(self, at: tuple[str, str], interface: str, method: str, *arguments: object) -> object:
        thing = self._bus.get_object(at[0], at[1], introspect=False)
        return thing.get_dbus_method(method, interface)(*arguments)

    def _below(self, at: tuple[str, str]) -> list[Thing]:
        found = []
        for child in self._ask(at, ACCESSIBLE, "GetChildren"):
            try:
                found += self._one(child, is_program=at == self._root) + self._below(child)
            except dbus.exceptions.DBusException:
                continue  # it went away meanwhile
        return found

    def _one(self, at: tuple[str, str], is_program: bool) -> list[Thing]:
        name = str(self._ask(at, dbus.PROPERTIES_IFACE, "Get", ACCESSIBLE, "Name"))
        if is_program or not name:
            return []
        place = self._ask(at, "org.a11y.atspi.Component", "GetExtents", dbus.UInt32(0))
        return [Thing(name, int(self._ask(at, ACCESSIBLE, "GetRole")), *map(int, place))]

    def things(self) -> list[Thing]:
        """Everything that has a name now, in the order of the screen reader."""
        return self._below(self._root)

    def all(self, name: str, role: Optional[int] = None) -> list[Thing]:
        """All that are called so (`*` at the end: that begin so)."""
        def is_it(thing: Thing) -> bool:
            named = thing.name.startswith(name[:-1]) if name.endswith("*") else thing.name == name
            return named and role in (None, thing.role)

        return [thing for thing in self.things() if is_it(thing)]

    def find(self, name: str, role: Optional[int] = None, which: int = 0) -> Thing:
        """Waits until one that is called so is there and stands still."""
        found: list[Thing] = []

        def stands() -> bool:
            nonlocal found
            before, found = found, self.all(name, role)
            return found == before and len(found) > (which if which >= 0 else -which - 1)

        wait_for(f"{name!r} on the screen", stands, lambda: "\n".join(str(thing) for thing in self.things()))
        return found[which]


def wait_for(what: str, is_so: Callable[[], object], instead: Callable[[], str] = lambda: "") -> None:
    """Waits until something is so; a machine may be slow, so nothing here is a fixed time."""
    ends = time.monotonic() + PATIENCE_S
    while not is_so():
        if time.monotonic() > ends:
            raise AssertionError(f"waited in vain for {what}\n{instead()}")
        time.sleep(0.1)
