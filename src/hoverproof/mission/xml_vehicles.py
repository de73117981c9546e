"""Vehicles of URDF, SDF and MJCF: masses and rotors of all bodies, put together in one frame."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from hoverproof.mission.described import VehicleFile, down

Array = NDArray[np.float64]

GRAVITY = 9.8
"""m/s², of gym-pybullet-drones."""
ROTOR = re.compile(r"rotor|prop|motor", re.IGNORECASE)
MOST_LEAN = 0.09
"""Sine of the lean of a rotor's axis beyond which it does not push straight up."""
ENTRIES = ("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz")
MAX_DEPTH = 100


class Pose(NamedTuple):
    """Where a frame is in another one.

    Attributes
    ----------
    place : (3,)
        m.
    turn : (3, 3)
        From its axes to those of the other.
    """

    place: Array
    turn: Array

    def then(self, inner: Pose) -> Pose:
        """Return the pose of a frame that is known in this one.

        Parameters
        ----------
        inner : Pose
        """
        return Pose(self.place + self.turn @ inner.place, self.turn @ inner.turn)


HERE = Pose(np.zeros(3), np.eye(3))


def read_xml(text: str, path: Path) -> VehicleFile:
    """Read URDF, SDF or MJCF.

    Parameters
    ----------
    text : str
    path : Path
        Of the file: models that one of SDF includes are looked for beside its folder.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    root = _root(text)
    for model in root.iter("model"):
        _include(model, path)
    readers = {"robot": _urdf, "sdf": _sdf, "mujoco": _mjcf}
    if root.tag not in readers:
        raise ValueError(f"<{root.tag}> is neither <robot> (URDF), <sdf> nor <mujoco>")
    return readers[root.tag](root)


def _root(text: str) -> ET.Element:
    if "<!ENTITY" in text or "<!DOCTYPE" in text:
        raise ValueError("it declares entities, which are not read")
    try:
        return ET.fromstring(text)
    except ET.ParseError as error:
        raise ValueError(f"it is not valid XML: {error}") from None


def _include(model: ET.Element, path: Path) -> None:
    """Put links and motors of models that one of SDF includes into it, if they lie beside it."""
    for include in model.findall("include"):
        name = (include.findtext("uri") or "").strip().removeprefix("model://")
        beside = path.resolve().parent.parent / name / "model.sdf"
        if include.findtext("pose", "").strip(" 0.\n") or not re.fullmatch(r"[\w-]+", name):
            continue  # a sensor, for one, that is mounted somewhere
        if not beside.is_file():
            if model.find("link") is None:
                raise ValueError(f"it includes {name}, and there is no {name}/model.sdf beside it")
            continue
        for other in _root(beside.read_text(encoding="utf-8")).findall("model"):
            model.extend(other)


def _upright(axis: Array, name: str) -> None:
    """Refuse a rotor that does not push along the z axis of the body."""
    sine = float(np.linalg.norm(axis[:2]) / np.linalg.norm(axis))
    if sine > MOST_LEAN:
        lean = math.degrees(math.asin(min(sine, 1)))
        told = f"its rotor {name} leans by {lean:.3g} degrees"
        raise ValueError(f"{told}: each is to push straight up")


def _numbers(text: str | None, count: int) -> Array:
    if text is None:
        return np.zeros(count)
    found = np.array([float(word) for word in text.split()])
    if len(found) != count or not np.isfinite(found).all():
        raise ValueError(f"{text.strip()[:40]!r} is not {count} numbers")
    return found


def _roll_pitch_yaw(angles: Array) -> Array:
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _quaternion(q: Array) -> Array:
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _body(pose: Pose, mass: float, inertia: Array) -> tuple[float, Array, Array]:
    return mass, pose.place, pose.turn @ inertia @ pose.turn.T


def _matrix(entries: dict[str, str]) -> Array:
    return np.array([[float(entries.get(name, "0")) for name in row] for row in ENTRIES])


# --- URDF: a tree of links, each placed by the joint above it -------------------------------------


def _urdf(root: ET.Element) -> VehicleFile:
    joints: dict[str | None, ET.Element] = {}
    for joint in root.iter("joint"):
        for child in joint.findall("child"):
            joints[child.get("link")] = joint

    def origin(element: ET.Element | None) -> Pose:
        found = None if element is None else element.find("origin")
        if found is None:
            return HERE
        return Pose(_numbers(found.get("xyz"), 3), _roll_pitch_yaw(_numbers(found.get("rpy"), 3)))

    def pose(link: str | None, depth: int = 0) -> Pose:
        joint = joints.get(link)
        if joint is None:
            return HERE
        if depth > MAX_DEPTH:
            raise ValueError("its joints make a circle")
        parent = joint.find("parent")
        above = HERE if parent is None else pose(parent.get("link"), depth + 1)
        return above.then(origin(joint))

    bodies, rotors = [], []
    for link in root.iter("link"):
        name, inertial = link.get("name") or "", link.find("inertial")
        here = pose(name)
        if inertial is not None:
            mass, moments = inertial.find("mass"), inertial.find("inertia")
            at = here.then(origin(inertial))
            entries = {} if moments is None else dict(moments.attrib)
            value = 0.0 if mass is None else float(mass.get("value", "0"))
            bodies.append(_body(at, value, _matrix(entries)))
            here = at
        above = joints.get(name)
        if above is not None and ROTOR.search(name) and above.get("type") != "prismatic":
            axis = None if above.get("type") == "fixed" else above.find("axis")
            along = "0 0 1" if axis is None else axis.get("xyz", "1 0 0")
            _upright(pose(name).turn @ _numbers(along, 3), name)
            rotors.append((here.place, 0, None))
    return _with_properties(down("URDF", bodies, _apart(rotors)), root.find("properties"))


def _with_properties(found: VehicleFile, said: ET.Element | None) -> VehicleFile:
    """Add what gym-pybullet-drones says of rotors: thrust and torque over speed², and the most."""
    if said is None or not {"kf", "km", "thrust2weight"} <= set(said.keys()) or not found.rotors:
        return found
    kf, km, times = (float(said.get(key, "0")) for key in ("kf", "km", "thrust2weight"))
    most = times * (found.mass or 0) * GRAVITY / len(found.rotors)
    return replace(
        found,
        drag_ratio=km / kf if kf else None,
        rotors=tuple(replace(rotor, thrust_max=most) for rotor in found.rotors),
    )


# --- SDF: links with poses in the model; motors are plugins ---------------------------------------


def _sdf(root: ET.Element) -> VehicleFile:
    model = root.find(".//model")
    if model is None:
        raise ValueError("it has no <model>")

    def own(element: ET.Element) -> Pose:
        text = element.findtext("pose")
        numbers = _numbers(text if text and text.strip() else None, 6)
        return Pose(numbers[:3], _roll_pitch_yaw(numbers[3:]))

    links = {link.get("name") or "": link for link in model.findall("link")}

    def pose(name: str, depth: int = 0) -> Pose:
        if depth > MAX_DEPTH:
            raise ValueError("its poses make a circle")
        found = links[name].find("pose")
        above = None if found is None else found.get("relative_to")
        outer = pose(above, depth + 1) if above in links else HERE
        return outer.then(own(links[name]))

    bodies, rotors, motors = [], [], dict(_motors(root))
    for name, link in links.items():
        here, inertial = pose(name), link.find("inertial")
        if inertial is not None:
            mass = float(inertial.findtext("mass") or "0")
            entries = {e.tag: e.text or "0" for e in inertial.findall("inertia/*")}
            bodies.append(_body(here.then(own(inertial)), mass, _matrix(entries)))
        if name in motors or (not motors and ROTOR.search(name)):
            _upright(here.turn[:, 2], name)  # its thrust is along z of the link
            motor = motors.get(name, {})
            turning = motor.get("turningDirection", "").strip()
            rotors.append((here.place, {"ccw": 1, "cw": -1}.get(turning, 0), _most(motor)))
    constants = next(iter(motors.values()), {})
    ratio, lag = constants.get("momentConstant"), constants.get("timeConstantUp")
    return down(
        "SDF",
        bodies,
        rotors,
        drag_ratio=float(ratio) if ratio else None,
        rotor_lag=float(lag) if lag else None,
    )


def _most(motor: dict[str, str]) -> float | None:
    """Return the thrust of a motor at its highest speed, N, if that is said."""
    if "maxRotVelocity" not in motor:
        return None
    return float(motor["motorConstant"]) * float(motor["maxRotVelocity"]) ** 2


def _motors(root: ET.Element) -> Iterator[tuple[str, dict[str, str]]]:
    for plugin in root.iter("plugin"):
        said = {e.tag: e.text or "" for e in plugin}
        if "motorConstant" in said and "linkName" in said:
            yield said["linkName"].strip().split("::")[-1], said


# --- MJCF: bodies in bodies; mass by <inertial> or by solid geoms; motors at sites ----------------


def _mjcf(root: ET.Element) -> VehicleFile:
    defaults = dict(_defaults(root.find("default"), {}))
    by_geoms = (root.find("compiler") or ET.Element("c")).get("inertiafromgeom", "auto")
    bodies: list[tuple[float, Array, Array]] = []
    sites: dict[str, Pose] = {}

    def said(element: ET.Element, childclass: str) -> dict[str, str]:
        of = defaults.get(element.get("class") or childclass, {})
        return {**of.get(element.tag, {}), **element.attrib}

    def pose(entries: dict[str, str]) -> Pose:
        turn = np.eye(3)
        if "quat" in entries:
            turn = _quaternion(_numbers(entries["quat"], 4))
        elif {"euler", "axisangle", "xyaxes", "zaxis"} & entries.keys():
            raise ValueError("it turns bodies otherwise than by quat, which is not read")
        return Pose(_numbers(entries.get("pos"), 3), turn)

    def walk(body: ET.Element, outer: Pose, childclass: str, depth: int) -> None:
        if depth > MAX_DEPTH:
            raise ValueError("it nests bodies too deep")
        childclass = body.get("childclass") or childclass
        here = outer.then(pose(dict(body.attrib))) if depth else HERE
        inertial = body.find("inertial")
        if inertial is not None:
            at = here.then(pose(dict(inertial.attrib)))
            bodies.append(_body(at, float(inertial.get("mass", "0")), _of_mjcf(inertial)))
        for geom in body.findall("geom") if inertial is None or by_geoms == "true" else ():
            entries = said(geom, childclass)
            if (mass := float(entries.get("mass", "0"))) > 0:
                bodies.append(_body(here.then(pose(entries)), mass, mass * _solid(entries)))
        for site in body.findall("site"):
            sites[site.get("name") or ""] = here.then(pose(said(site, childclass)))
        for inner in body.findall("body"):
            walk(inner, here, childclass, depth + 1)

    world = root.find("worldbody")
    first = None if world is None else world.find("body")
    if first is None:
        raise ValueError("it has no <body>")
    walk(first, HERE, "main", 0)
    rotors, ratios = [], []
    for motor in root.findall("actuator/*"):
        gear, site = motor.get("gear"), motor.get("site") or ""
        if gear is None or site not in sites or len(gear.split()) != 6:
            continue
        force, turning = _numbers(gear, 6)[2], _numbers(gear, 6)[5]
        if force and turning:  # thrust up; the body is turned against the rotor
            _upright(sites[site].turn @ _numbers(gear, 6)[:3], site)
            span = motor.get("ctrlrange")
            most = None if span is None else force * _numbers(span, 2)[1]
            rotors.append((sites[site].place, int(-math.copysign(1, turning / force)), most))
            ratios.append(abs(turning / force))
    return down("MJCF", bodies, rotors, drag_ratio=ratios[0] if ratios else None)


def _defaults(
    element: ET.Element | None, above: dict[str, dict[str, str]]
) -> Iterator[tuple[str, dict[str, dict[str, str]]]]:
    if element is None:
        return
    own = {name: dict(of) for name, of in above.items()}
    for entry in element:
        if entry.tag != "default":
            own[entry.tag] = {**own.get(entry.tag, {}), **entry.attrib}
    yield element.get("class") or "main", own
    for inner in element.findall("default"):
        yield from _defaults(inner, own)


def _of_mjcf(inertial: ET.Element) -> Array:
    if (full := inertial.get("fullinertia")) is not None:
        xx, yy, zz, xy, xz, yz = _numbers(full, 6)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.diag(_numbers(inertial.get("diaginertia"), 3))


def _solid(entries: dict[str, str]) -> Array:
    """Return the inertia of a solid geom over its mass, (3, 3), m²."""
    kind, size = entries.get("type", "sphere"), entries.get("size", "0").split()
    a, b, c = (float(s) for s in [*size, "0", "0"][:3])
    if kind == "sphere":
        return np.eye(3) * 0.4 * a * a
    if kind in ("ellipsoid", "box"):
        share = 1 / 5 if kind == "ellipsoid" else 1 / 3  # sizes are half-axes
        return share * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    if kind == "cylinder":  # radius, half-length
        across = a * a / 4 + b * b / 3
        return np.diag([across, across, a * a / 2])
    raise ValueError(f"a geom of type {kind!r} has a mass, and its inertia is not known here")


def _apart(rotors: list[tuple[Array, int, None]]) -> list[tuple[Array, int, None]]:
    """Drop rotors that stand where another one does, as a propeller on its motor."""
    kept: list[tuple[Array, int, None]] = []
    for rotor in rotors:
        if all(np.linalg.norm((rotor[0] - other)[:2]) > 1e-6 for other, *_ in kept):
            kept.append(rotor)
    return kept
