"""Run an exported package from Python: the very C that goes on the vehicle."""

from __future__ import annotations

import ctypes
import json
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hoverproof.compilers import command_words, find_compiler
from hoverproof.errors import InputError
from hoverproof.export.structs import put, structs_of
from hoverproof.spread import interruptibly

FLAGS = (
    *("-std=c99", "-O2", "-fPIC", "-shared", "-fno-math-errno", "-ffp-contract=off"),
    "-fvisibility=default",
)
"""The package's own flags, for a shared library; no machine flags: the bits are the target's."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Output:
    """What a step gave.

    Attributes
    ----------
    status : int
        0, or a sum of the status bits in the package's header.
    thrust, thrust_rate : float
        N and N/s.
    torque : (3,) float
        Body frame, N m.
    rotor : (n,) float
        N.
    throttle : float
        Share of the full thrust, a number from 0 to 1, of a package for a rate loop.
    rate_command : (3,) float
        Body frame, rad/s, likewise.
    """

    status: int
    thrust: float
    thrust_rate: float
    torque: tuple[float, ...]
    rotor: tuple[float, ...]
    throttle: float = float("nan")
    rate_command: tuple[float, ...] = ()


class Firmware:
    """An exported package, compiled for this computer and loaded.

    Parameters
    ----------
    folder : str or Path
        The package.
    compiler : str, optional
        Command of the C compiler; by default ``$CC``, or cc, gcc or clang, whichever is there.

    Raises
    ------
    InputError
        If the folder holds no package, or there is no C compiler that can build it.
    """

    def __init__(self, folder: str | Path, *, compiler: str | None = None) -> None:
        folder = Path(folder)
        try:
            self.manifest: dict[str, Any] = json.loads(
                (folder / "manifest.json").read_text("utf-8")
            )
            self.name = str(self.manifest["name"])
            headers = [f"{self.name}.h"]
            headers += [f"{self.name}_{k}.h" for k in ("camera", "lens") if k in self.manifest]
            header = "".join((folder / path).read_text("utf-8") for path in headers)
        except (OSError, ValueError, KeyError):
            raise InputError(str(folder), "", "is no firmware package: see `export`") from None
        self._real = {"float32": ctypes.c_float, "float64": ctypes.c_double}[
            self.manifest["precision"]
        ]
        self._structs = structs_of(header, self.name)
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as build:
            library = _built(folder, self.name, compiler, Path(build))
            try:
                self._library = ctypes.CDLL(str(library))  # what is loaded needs no file
            except OSError as error:
                reason = f"was compiled, but cannot be loaded here: {error}"
                raise InputError(str(folder), "", reason) from None
        self._params = self._new("params")
        self._state = self._new("state")
        self._call("init", self._params)
        self.reset()

    @property
    def thrust_excess(self) -> float:
        """T - m g in the state, N."""
        return float(self._state.thrust_excess)

    @thrust_excess.setter
    def thrust_excess(self, value: float) -> None:
        self._state.thrust_excess = value

    def reset(self, thrust: float | None = None) -> int:
        """Start from a thrust in N, by default that of hover, and return the status.

        Parameters
        ----------
        thrust : float, optional
            N.
        """
        hover = self._design.mass * self._design.gravity
        return self._call("reset", self._params, self._state, hover if thrust is None else thrust)

    def set_rotor_limits(self, lowest: float, highest: float) -> int:
        """Set the limits of each rotor, N, and return the status.

        Parameters
        ----------
        lowest, highest : float
            Of the thrust of one rotor, N.
        """
        return self._call("set_rotor_limits", self._params, lowest, highest)

    def set_gains(self, gains: Sequence[float]) -> int:
        """Set the gains of a tunable package and return the status.

        Parameters
        ----------
        gains : sequence of float
            In the order and units of the header, (5,) for the paper's law.

        Raises
        ------
        ValueError
            If they are more or fewer.
        """
        count = len(self._design.gains)
        if len(gains) != count:
            raise ValueError(f"{self.name} has {count} gains, not {len(gains)}")
        return self._call("set_gains", self._params, (self._real * count)(*gains))

    def selftest(self) -> int:
        """Return 0 if every built-in vector holds bit for bit, else the first that does not."""
        return self._call("selftest") or ("lens" in self.manifest and self._call("lens_selftest"))

    def lens(self, pixels: Any) -> tuple[int, Array]:
        """Return the status and the undistorted image points of pixels, of a package with a lens.

        Parameters
        ----------
        pixels : (n, 2)
            px, one for each target point.
        """
        given = np.ascontiguousarray(pixels, self._real)
        image = np.zeros_like(given)
        pointers = (ctypes.c_void_p(a.ctypes.data) for a in (given, image))
        return int(getattr(self._library, f"{self.name}_lens")(*pointers)), image.astype(float)

    def step(self, seen: Any, **rest: Any) -> Output:
        """Run one step.

        Parameters
        ----------
        seen : (n, 2) image points, or (3,) centroid, or (3,) feature
        **rest
            velocity (3,) m/s, rate (3,) rad/s, gravity_direction (3,), dt in s; specific_force
            (3,) m/s², of a law that measures it; target_seen, by default True.
        """
        values = self._named("sensing", seen) | {"target_seen": True} | rest
        given = self._filled("input", **values)
        out = self._new("output")
        status = self._call("step", self._params, self._state, given, out)
        names = ("thrust", "thrust_rate", "torque", "rotor", "throttle", "rate_command")
        told = {name: getattr(out, name) for name in names if hasattr(out, name)}
        one: dict[str, Any] = {k: v for k, v in told.items() if isinstance(v, float)}
        rows: dict[str, Any] = {k: tuple(told[k]) for k in told.keys() - one.keys()}
        return Output(status, **one, **rows)

    def take_over(self, specific_force: Sequence[float], throttle: float) -> int:
        """Take over from an autopilot, of a package for a rate loop, and return the status.

        Parameters
        ----------
        specific_force : (3,)
            That it feels, body frame, m/s².
        throttle : float
            That it flies with, a number from 0 to 1.
        """
        felt = (self._real * 3)(*specific_force)
        return self._call("take_over", self._params, self._state, felt, throttle)

    def watch(self, oldest: float) -> int:
        """Forget all frames, use each until it is so old, and return the status.

        Parameters
        ----------
        oldest : float
            s.
        """
        self._camera = self._new("camera")
        return self._call("camera_init", self._camera, oldest)

    def see_heading(self, image: Any, gravity_direction: Any) -> tuple[float, ...]:
        """Return the heading that the image tells, (cos ψ, sin ψ), of a package that has it so.

        Parameters
        ----------
        image : (n, 2)
            Image points in the order of the target.
        gravity_direction : (3,)
            Body frame.
        """
        given = self._filled("input", image=image, gravity_direction=gravity_direction)
        self._call("see_heading", given)
        return tuple(given.heading)

    def frame(self, seen: Any, age: float, **rest: Any) -> int:
        """Take in a frame, after `watch`, and return the status.

        Parameters
        ----------
        seen : (n, 2) image points, or (3,) centroid
        age : float
            From its exposure to the next step, s.
        **rest
            gravity_direction (3,) at its exposure, where the image tells the heading.
        """
        frame = self._filled("frame", **self._named("camera", seen), age=age, **rest)
        return self._call("camera", self._camera, frame)

    def turn(self, rate: Sequence[float], dt: float) -> tuple[int, tuple[float, ...]]:
        """Turn the newest frame to this step, after `watch`; return the status and the feature.

        Parameters
        ----------
        rate : (3,)
            At this step, rad/s.
        dt : float
            To the next step, s.

        Returns
        -------
        status, feature : int, (3,) float
            The feature is for `step`, with the target seen if the status is 0.
        """
        status, given = self._turned(rate=rate, dt=dt)
        return status, tuple(given.feature)

    def turn_heading(
        self, rate: Sequence[float], dt: float, gravity_direction: Sequence[float]
    ) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """Do as `turn` where the image tells the heading; return status, feature and heading.

        Parameters
        ----------
        rate : (3,)
            At this step, rad/s.
        dt : float
            To the next step, s.
        gravity_direction : (3,)
            At this step, body frame.
        """
        status, given = self._turned(rate=rate, dt=dt, gravity_direction=gravity_direction)
        return status, tuple(given.feature), tuple(given.heading)

    def _turned(self, **values: Any) -> tuple[int, Any]:
        given = self._filled("input", **values)
        return self._call("camera_turn", self._camera, given), given

    def _named(self, key: str, seen: Any) -> dict[str, Any]:
        """Return what is seen by the name of its field."""
        field = str(self.manifest[key])
        return {"image" if field == "points" else field: seen}

    def _filled(self, kind: str, **values: Any) -> ctypes.Structure:
        given: ctypes.Structure = self._new(kind)
        for key, value in values.items():
            put(given, key, value)
        return given

    def fly(self, dt: float, samples: int, every: int) -> Mapping[str, Any]:
        """Fly the mission from its start with the package's simulated vehicle.

        Parameters
        ----------
        dt : float
            s from one step of the controller, and of RK4, to the next.
        samples, every : int
            A sample is kept before every so many steps, and one at the end.

        Returns
        -------
        mapping
            state (m, 18): ξ, V, R column by column, Ω; thrust (m,) N, torque (m, 3) N m, rotor
            (m, n) N, status (m,): m = samples + 1, or fewer if a fault ended the flight; and
            any_status, all bits that came up in between.
        """
        rotors = len(self._structs["output"]().rotor)
        rows, bits = np.zeros((samples + 1, ROW + rotors)), np.zeros(samples + 2, np.uint32)
        stop = ctypes.c_int(0)

        def end() -> None:
            stop.value = 1

        fly = self._library.hoverproof_fly
        fly.restype = ctypes.c_long
        times = ctypes.c_double(dt), ctypes.c_long(samples), ctypes.c_long(every)
        places = [ctypes.c_void_p(a.ctypes.data) for a in (rows, bits)]
        taken = interruptibly(lambda: fly(*times, *places, ctypes.byref(stop)), end)
        rows = rows[:taken]
        return {
            "state": rows[:, :18],
            "thrust": rows[:, 18],
            "torque": rows[:, 19:22],
            "rotor": rows[:, 22:],
            "status": bits[:taken],
            "any_status": int(bits[-1]),
        }

    @property
    def _design(self) -> Any:
        return self._structs["design"].in_dll(self._library, f"{self.name}_design")

    def _new(self, kind: str) -> Any:
        return self._structs[kind]()

    def _call(self, verb: str, *arguments: Any) -> int:
        """Call a function, structs by reference; what answers nothing answers anything."""
        function = getattr(self._library, f"{self.name}_{verb}")
        function.restype = ctypes.c_uint32
        given = [
            ctypes.byref(a)
            if isinstance(a, ctypes.Structure)
            else a
            if isinstance(a, ctypes.Array)
            else self._real(a)
            for a in arguments
        ]
        return int(function(*given))


ROW = 22
"""Numbers in a row of a flight, besides the rotors."""


def _built(folder: Path, name: str, compiler: str | None, build: Path) -> Path:
    """Compile a package with the loop of `Firmware.fly` and return the shared library."""
    loop = (resources.files("hoverproof.export") / "loop.c").read_text("utf-8")
    library = build / f"{name}.so"
    (build / "loop.c").write_text(loop.replace("NAME", name), encoding="utf-8", newline="\n")
    sources = [folder / f"{name}.c", folder / f"{name}_selftest.c", folder / "example/vehicle.c"]
    sources += [*folder.glob(f"{name}_camera.c"), *folder.glob(f"{name}_lens.c")]
    words = command_words(compiler or find_compiler())
    if not words:
        reason = "firmware needs a C compiler; none was found (or set CC)"
        raise InputError("--controller", "", reason)
    command = [
        *words,
        *FLAGS,
        *(f"-I{folder.absolute()}", f"-I{(folder / 'example').absolute()}"),
        *(str(path.absolute()) for path in sources),
        *(str(build / "loop.c"), "-lm", "-o", str(library)),
    ]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, errors="replace", check=False
        )
    except OSError as error:
        raise InputError(command[0], "", f"cannot be run: {error.strerror}") from None
    if done.returncode:
        last = done.stderr.strip().splitlines()[-1:] or ["no message"]
        raise InputError(str(folder), "", f"cannot be compiled with {command[0]}: {last[0]}")
    return library
