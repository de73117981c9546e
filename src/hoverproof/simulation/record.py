"""A flight in arrays with names, units and axes: written to a file, or shown as a Dataset.

xarray takes longer to import than most flights to fly, so it is left to those who ask for it.
"""

from __future__ import annotations

import io
import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hoverproof.algebra.derived import kept_json
from hoverproof.algebra.graph import fingerprint
from hoverproof.mission.sections import Mission
from hoverproof.servo.law import Law
from hoverproof.servo.laws.hamel_mahony import HAMEL_MAHONY
from hoverproof.servo.loop import LoopNumbers, readout_function
from hoverproof.simulation.numbers import euler_angles
from hoverproof.simulation.step import step_function
from hoverproof.version import __version__

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Recorded: TypeAlias = "xr.Dataset | Record"
"""What a picture is drawn of: values, names of axes and attributes are asked for alike."""


CHECKED_ROWS = 8192
"""A checksum in a file is of so many rows of a quantity."""


@dataclass(frozen=True)
class Column:
    """What is kept of one quantity.

    Attributes
    ----------
    dims : tuple of str
        Names of its axes.
    values : ndarray, any shape
        An axis for each of them, in the unit that the attributes tell.
    attrs : dict
        ``units`` and ``long_name``.
    """

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: Mapping[str, str]


@dataclass(frozen=True)
class Record:
    """A flight, or another table over time.

    Attributes
    ----------
    variables, coordinates : dict of Column
        By name; a coordinate has the name of its one axis.
    attrs : dict
        What is true of the whole: the mission, the outcome, versions.
    """

    variables: dict[str, Column]
    coordinates: dict[str, Column]
    attrs: dict[str, Any]

    def __getitem__(self, name: str) -> Column:
        return (self.variables | self.coordinates)[name]

    def until(self, time: float) -> Record:
        """Return the part up to a time.

        Parameters
        ----------
        time : float
            s.
        """
        kept = self["time"].values <= time

        def cut(column: Column) -> Column:
            timed = column.dims[:1] == ("time",)
            return replace(column, values=column.values[kept]) if timed else column

        variables = {name: cut(column) for name, column in self.variables.items()}
        coordinates = {name: cut(column) for name, column in self.coordinates.items()}
        return replace(self, variables=variables, coordinates=coordinates)

    def add(self, name: str, dims: Sequence[str], values: NDArray[Any], **attrs: str) -> None:
        """Add a variable.

        Parameters
        ----------
        name : str
        dims : sequence of str
            Names of its axes.
        values : ndarray, any shape
        **attrs
            ``units`` and ``long_name``.
        """
        self.variables[name] = Column(tuple(dims), values, attrs)

    def dataset(self) -> xr.Dataset:
        """Return it as a Dataset, which shares the arrays."""
        import xarray as xr

        def given(columns: dict[str, Column]) -> dict[str, Any]:
            return {name: (c.dims, c.values, c.attrs) for name, c in columns.items()}

        return xr.Dataset(given(self.variables), given(self.coordinates), self.attrs)

    def netcdf(self) -> memoryview:
        """Return a netCDF-4 file, as xarray would write it, with checksums of the numbers."""
        import h5netcdf
        import h5py

        content = io.BytesIO()
        with h5netcdf.File(content, "w") as file:
            for name, column in self.coordinates.items():
                file.dimensions[name] = len(column.values)
            for name, column in (self.variables | self.coordinates).items():
                kind: Any = column.values.dtype
                values = column.values
                if kind.kind == "U":
                    kind, values = h5py.string_dtype(), values.astype(object)
                missing = np.nan if column.values.dtype.kind == "f" else None
                checked = {}
                if values.ndim and values.size and np.issubdtype(column.values.dtype, np.number):
                    chunks = (min(len(values), CHECKED_ROWS), *values.shape[1:])
                    checked = {"chunks": chunks, "fletcher32": True}
                made = file.create_variable(
                    name, column.dims, kind, values, fillvalue=missing, **checked
                )
                made.attrs.update(column.attrs)
            file.attrs.update(self.attrs)
        return content.getbuffer()

    def csv(self) -> str:
        """Return what has the axis of time as lines of numbers, a column for each component.

        A component is named by its places along the other axes, as ``pixel_1_u``; what is not a
        number is left empty.
        """
        times = self["time"].values
        columns = {"time": times}
        for name, column in self.variables.items():
            if column.dims[0] != "time":
                continue
            flat = column.values.reshape(len(times), -1)
            places = itertools.product(*(map(str, self[d].values) for d in column.dims[1:]))
            for part, place in zip(flat.T, places, strict=True):
                columns["_".join((name, *place))] = part
        rows = zip(*(c.tolist() for c in columns.values()), strict=True)
        lines = [",".join("" if x != x else f"{x:.9g}" for x in row) for row in rows]
        return "\n".join([",".join(columns), *lines]) + "\n"


@kept_json
def model_fingerprint(n: int, law: Law = HAMEL_MAHONY) -> str:
    """Return the SHA-256 of the graph of a step.

    Parameters
    ----------
    n : int
        Number of target points.
    law : Law
    """
    return fingerprint(step_function(n, law))


def feature_words(law: Law) -> str:
    """Say what a law makes of the image.

    Parameters
    ----------
    law : Law
    """
    name = law.feature.name
    return "image centroid" if name == "centroid" else f"{name} feature of the image"


def flight_record(
    mission: Mission,
    numbers: LoopNumbers,
    states: Array,
    times: NDArray[Any],
    specific_force: Array | None = None,
) -> Record:
    """Return states of a flight as a record, with all that is read off them.

    Parameters
    ----------
    mission : Mission
    numbers : LoopNumbers
        Of the mission.
    states : (n, 19)
        Packed, a row each sample; see `hoverproof.plant.rigid_body.RigidBodyState`.
    times : (n,)
        Of the samples, s.
    specific_force : (n, 3), optional
        Of the true vehicle, body frame, m/s², which is in the errors of a law that measures it; by
        default it follows from the model.

    Returns
    -------
    Record
        As `flown` returns it, but for the attributes that tell what flew, and how it ended.
    """
    n = numbers.points.shape[1]
    read = _columns(mission, numbers, states, specific_force)
    rotation = states[:, 6:15].reshape(-1, 3, 3).transpose(0, 2, 1)
    body, world, point = ("time", "body_axis"), ("time", "axis"), ("time", "point", "image_axis")
    seen = feature_words(numbers.law)
    seen += " q" if seen == "image centroid" else ""
    tilt = np.arctan2(np.hypot(rotation[:, 2, 0], rotation[:, 2, 1]), rotation[:, 2, 2])
    variables: dict[str, tuple[Any, Array, str, str]] = {
        "position": (world, states[:, 0:3], "m", "position ξ, world frame, z down"),
        "velocity": (body, states[:, 3:6], "m/s", "velocity V, body frame"),
        "rotation": (("time", "axis", "body_axis"), rotation, "1", "rotation R, body to world"),
        "euler_angles": (
            ("time", "angle"),
            euler_angles(rotation),
            "rad",
            "R = Rz(yaw) Ry(pitch) Rx(roll)",
        ),
        "tilt": (("time",), tilt, "rad", "angle between body and world vertical"),
        "body_rate": (body, states[:, 15:18], "rad/s", "angular velocity Ω, body frame"),
        "thrust": (("time",), states[:, 18], "N", "thrust T"),
        "torque": (body, read["torque"], "N m", "torque Γ, body frame"),
        "rotor_thrust": (("time", "rotor"), read["rotor_thrusts"], "N", "thrust of each rotor"),
        "image": (point, read["image"].reshape(-1, n, 2), "1", "pinhole image, focal length 1"),
        "centroid": (body, read["centroid"], "1", seen),
        "delta1": (body, read["delta1"], "1", "image error δ1"),
        "delta2": (body, read["delta2"], "1", "velocity error δ2"),
        "delta3": (body, read["delta3"], "1", "force error δ3"),
        "delta4": (("time", "horizontal_axis"), read["delta4"], "1", "body-rate error δ4"),
        "lyapunov": (("time",), read["lyapunov"][:, 0], "1", "L = ½ Σ|δᵢ|²"),
    }
    return Record(
        {
            name: Column(dims, values, {"units": units, "long_name": words})
            for name, (dims, values, units, words) in variables.items()
        },
        _coordinates(mission, times, n),
        attrs={
            "title": f"closed-loop flight of {mission.name}",
            "goal_position": numbers.goal,
            "goal_centroid": numbers.goal_centroid,
            "mission": json.dumps(mission.exact()),
            "law": numbers.law.name,
            "model_sha256": model_fingerprint(n, numbers.law),
            "hoverproof_version": __version__,
            "casadi_version": version("casadi"),
        },
    )


def _coordinates(mission: Mission, times: NDArray[Any], n: int) -> dict[str, Column]:
    """Return the coordinates of a flight with n target points, by name."""
    axes = list("xyz")
    values: dict[str, Sequence[str] | NDArray[Any]] = {
        "time": times,
        "axis": axes,
        "body_axis": axes,
        "horizontal_axis": axes[:2],
        "image_axis": axes[:2],
        "angle": ["roll", "pitch", "yaw"],
        "rotor": list(mission.vehicle.frame.names),
        "point": np.arange(1, n + 1),
    }
    units = {"time": {"units": "s"}}
    return {k: Column((k,), np.asarray(v), units.get(k, {})) for k, v in values.items()}


def _columns(
    mission: Mission, numbers: LoopNumbers, states: Array, specific_force: Array | None
) -> dict[str, Array]:
    """Evaluate the readout along the flight; each result is (samples, size)."""
    n, samples, own = numbers.target_size, len(states), []
    frame = mission.vehicle.frame
    if specific_force is None:
        read = readout_function(n, numbers.law, frame)
    else:
        read = readout_function(n, numbers.law, frame, with_specific_force=True)
        own = [specific_force.T]
    names: Callable[[int], str] = read.name_out
    held = (
        np.tile(numbers.design[:, None], samples),
        np.tile(numbers.points, samples),
        np.full((1, samples), float(mission.vehicle.reach)),
        np.full((1, samples), float(mission.vehicle.drag_ratio)),
    )
    outputs = read.map(samples)(states.T, *held, *own)
    return {names(i): np.array(output).T.reshape(samples, -1) for i, output in enumerate(outputs)}
