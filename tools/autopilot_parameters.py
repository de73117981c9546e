"""Parameters of PX4 and ArduPilot that the documentation names, looked up in a tree of theirs."""

from __future__ import annotations

import json
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from harnesses import Failure, run

GUIDE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "fly-over-mavlink.md"
TITLES = {"px4": "PX4", "ardupilot": "ArduPilot"}
NAMED = re.compile(r"`([A-Z][A-Z0-9]*x?(?:_[A-Z0-9]+)+)`(?: (-?\d+(?:\.\d+)?))?")
"""A name, with x where the number of a port is to be put, and the value that it is to be set to."""

OWN = re.compile(r"HPROOF_|CC3_")
"""Those that a package brings along."""

REGISTERED = "CC_TYPE"
"""The parameter that gets a further value where a package is registered."""

Parameters = list[tuple[str, Mapping[str, Any]]]
"""Of a tree: a regular expression of the name, and its `values`, `bit`, `min` and `max`, if any."""


def looked_up(title: str, tree: Path, package: Path) -> str:
    """Look up what guide and package say of an autopilot's parameters; say how many there are.

    Parameters
    ----------
    title : str
        px4 or ardupilot.
    tree : Path
    package : Path
    """
    texts = (GUIDE, package / "adapters" / "README.md")
    names = dict[str, set[str]]()
    for text in texts:
        for name, value in named(text.read_text(encoding="utf-8"), TITLES[title]):
            names.setdefault(name, set()).update({value} if value else ())
    known = of_px4(tree) if title == "px4" else of_ardupilot(tree)
    wrong = []
    for name, values in sorted(names.items()):
        pattern = re.compile(name.replace("x", r"\d+"))
        found = [told for regex, told in known if pattern.fullmatch(regex) or matches(regex, name)]
        if not found and not (title == "ardupilot" and is_code(name, tree)):
            wrong.append(f"no {name}")
        elif found and name != REGISTERED:
            wrong += [f"{name} is never {v}" for v in values if not may_be(found[0], float(v))]
    if wrong:
        raise Failure(f"of the parameters of the guide: {', '.join(wrong)}")
    return f"all {len(names)} parameters of the guide are there"


def named(text: str, title: str) -> Iterator[tuple[str, str]]:
    """Yield the parameters that a text names for an autopilot, and what they are to be set to."""
    plain = re.sub(r"^( *)```.*?^ *```$", "", text, flags=re.M | re.S)
    (section,) = re.findall(rf"^## {title}$(.*?)(?=^## |\Z)", plain, re.M | re.S)
    rows = re.findall(rf"^\| {title} \|.*$", plain, re.M)
    for name, value in NAMED.findall("\n".join([section, *rows])):
        if not OWN.match(name):
            yield name, value


def matches(regex: str, name: str) -> bool:
    """Tell whether a tree's pattern of names holds this name."""
    return re.fullmatch(regex, name) is not None


def may_be(told: Mapping[str, Any], value: float) -> bool:
    """Tell whether a parameter may have a value, as far as its tree says."""
    if "values" in told:
        return value in {float(v) for v in told["values"]}
    if "bit" in told:
        return not int(value) & ~sum(1 << int(b) for b in told["bit"])
    return float(told.get("min", "-inf")) <= value <= float(told.get("max", "inf"))


def of_px4(tree: Path) -> Parameters:
    """Return the parameters in the YAML files of a tree, and those that its scripts make."""
    found: Parameters = []
    for file in sorted((tree / "src").rglob("*.yaml")):
        text = file.read_text(encoding="utf-8")
        told = yaml.safe_load(text) if re.search(r"^module_name:", text, re.M) else {}
        for group in told.get("parameters", ()):
            for name, of in (group.get("definitions") or {}).items():
                key = "bit" if of.get("type") == "bitmask" else "values"
                kept = {k: of[k] for k in ("min", "max") if isinstance(of.get(k), int | float)}
                if of.get("type") in ("enum", "bitmask"):
                    kept = {key: of[key]}
                found.append((as_pattern(name), kept))
        for port in told.get("serial_config", ()):
            found.append((as_pattern(port["port_config_param"]["name"]), {}))
    made = re.compile(r"PARAM_DEFINE_(?:INT32|FLOAT)\(([^,)]+),")
    for file in [*(tree / "Tools" / "serial").glob("*.jinja"), *(tree / "src").rglob("*.c")]:
        text = file.read_text(encoding="utf-8", errors="replace")
        found += [(as_pattern(name.strip()), {}) for name in made.findall(text)]
    return found


def as_pattern(name: str) -> str:
    """Return a regular expression of a name with places to be filled in."""
    return re.sub(r"\$\{\w+\}|\{\{.*?\}\}", "[A-Z0-9]+", name)


def of_ardupilot(tree: Path) -> Parameters:
    """Return the parameters of ArduCopter, by the tree's own script."""
    script = tree / "Tools" / "autotest" / "param_metadata" / "param_parse.py"
    with tempfile.TemporaryDirectory() as folder:
        run(sys.executable, script, "--vehicle", "ArduCopter", "--format", "json", cwd=Path(folder))
        groups = json.loads((Path(folder) / "apm.pdef.json").read_text(encoding="utf-8"))
    found: Parameters = []
    for group in groups.values():
        for name, of in group.items():
            if not isinstance(of, dict):  # the version of the format
                continue
            limits = of.get("Range", {})
            kept = {k: limits[w] for k, w in (("min", "low"), ("max", "high")) if w in limits}
            kept = {"bit": of["Bitmask"]} if "Bitmask" in of else kept
            kept = {"values": [*filter(numeric, of["Values"])]} if "Values" in of else kept
            found.append((name, kept))
    return found


def numeric(text: str) -> bool:
    """Tell whether this is a number."""
    return re.fullmatch(r"-?\d+(\.\d+)?", text) is not None


def is_code(name: str, tree: Path) -> bool:
    """Tell whether this is a word of where a custom controller of ArduPilot is registered."""
    places = [*(tree / "libraries" / "AC_CustomControl").glob("*.*")]
    places += (tree / "Tools" / "ardupilotwaf").glob("*.py")
    return any(name in place.read_text(errors="replace") for place in places)
