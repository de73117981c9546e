"""What a report says of a vehicle's body: its inertia, and where its rotors are."""

from __future__ import annotations

from hoverproof.mission.frame import X
from hoverproof.mission.vehicle import Vehicle
from hoverproof.reporting.numerals import short


def body_rows(vehicle: Vehicle) -> list[tuple[str, str]]:
    """Return rows of a table, by name.

    Parameters
    ----------
    vehicle : Vehicle
    """
    named = "inertia" if vehicle.products is None else "inertia I11, I22, I33, I12, I13, I23"
    rows = [(named, f"{', '.join(map(short, vehicle.moments))} kg m²")]
    if vehicle.frame == X:
        return [*rows, ("lever of a rotor about roll and pitch axis", f"{short(vehicle.reach)} m")]
    places = [[short(c * vehicle.reach) for c in place] for place in vehicle.frame.places]
    where = (f"{n} ({', '.join(p)})" for n, p in zip(vehicle.frame.names, places, strict=True))
    return [*rows, ("rotors (x forward, y right)", f"{', '.join(where)} m")]
