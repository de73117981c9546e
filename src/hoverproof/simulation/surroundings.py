"""What stands around a control law in flight: the true vehicle, its sensors, rotors and air.

`Features` are the reasons to compile another loop. What a loop has only with some of them stands
behind the rest in its memory, parameters and records, so that the others stay what they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from hoverproof.mission.frame import Frame
from hoverproof.plant import camera, rotors
from hoverproof.plant.lens import LensModel, sight_of
from hoverproof.plant.rigid_body import STATE_SIZE, RigidBodyState, specific_force
from hoverproof.servo.law import Law
from hoverproof.servo.layout import Packed, column, resized, scalar
from hoverproof.simulation.flight_log import LOG_SIZE

LAYOUT = {
    "state": STATE_SIZE,
    "depth": 1,
    "thrust_margin": 1,
    "view": 1,
    "lost": 1,
    "lost_at": 1,
    "held": 3,
    "command": 1,
    "rotors": 4,
    "rotor_commands": 4,
    "gust": 3,
    "log": LOG_SIZE,
}
"""What a vehicle remembers: its state; the lowest depth (m), thrust margin (N) and view margin so
far; frames lost and the step of the first; the feature of the image held; the thrust commanded (N);
the rotors' thrusts and commands (N, as modelled); the gust (m/s, world frame); the log of the
flight."""

GYRO_LAYOUT = {"attitude": 4, "gyro_error": 3}
"""With features turned by the gyro: the attitude that it has added up since the start, a unit
quaternion, body to the axes in which features are then held; the error of its readings (rad/s)."""

NORTH_LAYOUT = {"north": 3}
"""With a heading from the image: the x axis of the world as the frame held tells it, body frame, or
with a gyro in the axes in which features are held."""

ACCELEROMETER_LAYOUT = {"accelerometer": 3}
"""With an accelerometer that lags: what it makes of the specific force (m/s², body frame)."""

RECORD = {
    "state": STATE_SIZE,
    "lyapunov": 1,
    "rotor_thrust": 4,
    "thrust_command": 1,
    "centroid_held": 3,
    "wind": 3,
    "rotor_command": 4,
}


@dataclass(frozen=True)
class Surroundings(Packed):
    """The true vehicle, its sensors, rotors and air; every field is an SX, scalar or (3, 1).

    Attributes
    ----------
    mass, inertia : SX
        Of the true vehicle, kg and kg m².
    camera_x, camera_y, camera_z : SX
        Axes of the camera in the body frame, (3, 1), dimensionless.
    wind : SX
        Mean, world frame, m/s.
    gyro_bias, velocity_bias, gravity_bias : SX
        rad/s, m/s and rad, body frame.
    arm, drag_ratio : SX
        Of the rotors, m; see `hoverproof.plant.rotors.wrench`.
    air_drag : SX
        kg/s.
    step, period : SX
        Of the integrator and of the controller, s.
    left_now, left_half, left_whole : SX
        What share of the gap to its command a rotor keeps at once, after half a step and a step;
        dimensionless.
    gust_kept, gust_added : SX
        A gust's share kept over a step, dimensionless, and the deviation added, m/s.
    rotor_min, rotor_max : SX
        Of each rotor, (n, 1), N.
    total_min, total_max : SX
        Of all together, N.
    image_noise, image_resolution, half_width, half_height : SX
        In focal lengths, dimensionless.
    gyro_noise, velocity_noise, gravity_noise : SX
        rad/s, m/s and rad.
    """

    mass: ca.SX = scalar("kg")
    inertia: ca.SX = column("kg m²")
    camera_x: ca.SX = column("1")
    camera_y: ca.SX = column("1")
    camera_z: ca.SX = column("1")
    wind: ca.SX = column("m/s")
    gyro_bias: ca.SX = column("rad/s")
    velocity_bias: ca.SX = column("m/s")
    gravity_bias: ca.SX = column("rad")
    arm: ca.SX = scalar("m")
    drag_ratio: ca.SX = scalar("m")
    air_drag: ca.SX = scalar("kg/s")
    step: ca.SX = scalar("s")
    period: ca.SX = scalar("s")
    left_now: ca.SX = scalar("1")
    left_half: ca.SX = scalar("1")
    left_whole: ca.SX = scalar("1")
    gust_kept: ca.SX = scalar("1")
    gust_added: ca.SX = scalar("m/s")
    rotor_min: ca.SX = column("N", 4)
    rotor_max: ca.SX = column("N", 4)
    total_min: ca.SX = scalar("N")
    total_max: ca.SX = scalar("N")
    image_noise: ca.SX = scalar("1")
    image_resolution: ca.SX = scalar("1")
    half_width: ca.SX = scalar("1")
    half_height: ca.SX = scalar("1")
    gyro_noise: ca.SX = scalar("rad/s")
    velocity_noise: ca.SX = scalar("m/s")
    gravity_noise: ca.SX = scalar("rad")

    def seen(self, body: RigidBodyState, points: ca.SX, law: Law) -> ca.SX:
        """Return the target points in the frame of the camera as it is mounted, (3, n), m.

        Parameters
        ----------
        body : RigidBodyState
        points : SX
            (3, n), world frame, m.
        law : Law
            Its camera sits where it says.
        """
        axes = ca.horzcat(self.camera_x, self.camera_y, self.camera_z)
        place = law.mount.place(body.position, body.rotation)
        return camera.body_points(points, place, body.rotation @ axes)

    def projected(self, image: ca.SX, lens: LensModel | None) -> tuple[ca.SX, ca.SX]:
        """Return what is read of an image, (2, n), and a margin above 0 if it is within its edges.

        It is in px through a lens, else the image itself.

        Parameters
        ----------
        image : SX
            (X/Z, Y/Z), (2, n).
        lens : LensModel or None
        """
        if lens is None or (sight := sight_of(lens)) is None:
            size = ca.fabs(image)
            across, along = self.half_width - size[0, :], self.half_height - size[1, :]
            return image, ca.fmin(ca.mmin(across), ca.mmin(along))
        pixels = ca.horzcat(*map(lens.pixel, ca.horzsplit(image)))
        whole = ca.repmat(ca.DM([lens.width, lens.height]), 1, image.shape[1])
        within = ca.mmin(ca.fmin(pixels, whole - pixels))
        beyond = (1.02 * sight.reach) ** 2 - ca.sum1(image * image)  # there pixels may come back
        return pixels, ca.fmin(within, ca.mmin(beyond))

    def thrusts(self, commanded: ca.SX) -> ca.SX:
        """Return what rotors push with that the controller takes to push so, (n, 1), N.

        Parameters
        ----------
        commanded : SX
            (n, 1), N.
        """
        return commanded

    def wrench(self, frame: Frame, commanded: ca.SX) -> ca.SX:
        """Return (T, Γ₁, Γ₂, Γ₃), (4, 1), N and N m, that act on the true vehicle.

        Parameters
        ----------
        frame : Frame
            Of the rotors.
        commanded : SX
            What the controller takes to be the thrust of each rotor, (n, 1), N.
        """
        return rotors.wrench(frame, commanded, self.arm, self.drag_ratio)

    def drag(self, body: RigidBodyState, gust: ca.SX) -> ca.SX:
        """Return the force of the air, (3, 1), body frame, N.

        Parameters
        ----------
        body : RigidBodyState
        gust : SX
            (3, 1), world frame, m/s.
        """
        air = body.rotation.T @ (self.wind + gust)
        return self.air_drag * (air - body.velocity)

    def specific_force(self, body: RigidBodyState, gust: ca.SX) -> ca.SX:
        """Return a = V̇ + Ω × V - g ρ of the true vehicle, (3, 1), body frame, m/s².

        Parameters
        ----------
        body : RigidBodyState
        gust : SX
            (3, 1), world frame, m/s.
        """
        return specific_force(body.thrust, self.mass, self.drag(body, gust))


@dataclass(frozen=True)
class FurtherSurroundings(Surroundings):
    """What there is besides with an accelerometer, or rotors that are not as modelled.

    Attributes
    ----------
    accelerometer_bias : SX
        Body frame, m/s².
    accelerometer_noise : SX
        m/s².
    accelerometer_kept, accelerometer_newest : SX
        What shares an accelerometer that lags keeps of its value over a step, and takes of the
        specific force at the end of it; dimensionless.
    rotor_shares : SX
        Thrust of each rotor over what the controller takes it to be, (n, 1), dimensionless.
    true_arm : SX
        Where `arm` is what the controller knows, m.
    """

    accelerometer_bias: ca.SX = column("m/s²")
    accelerometer_noise: ca.SX = scalar("m/s²")
    accelerometer_kept: ca.SX = scalar("1")
    accelerometer_newest: ca.SX = scalar("1")
    rotor_shares: ca.SX = column("1", 4)
    true_arm: ca.SX = scalar("m")

    def thrusts(self, commanded: ca.SX) -> ca.SX:
        """Return what rotors push with; see `Surroundings.thrusts`.

        Parameters
        ----------
        commanded : SX
            (n, 1), N.
        """
        return self.rotor_shares * commanded

    def wrench(self, frame: Frame, commanded: ca.SX) -> ca.SX:
        """Return what acts on the vehicle; see `Surroundings.wrench`.

        Parameters
        ----------
        frame : Frame
            Of the rotors.
        commanded : SX
            (n, 1), N.
        """
        return rotors.wrench(frame, self.thrusts(commanded), self.true_arm, self.drag_ratio)

    def lagging(self, held: ca.SX, first: ca.SX, last: ca.SX) -> ca.SX:
        """Return what a first-order low-pass holds after a step, (3, 1), m/s².

        It is exact for a specific force that changes linearly over the step.

        Parameters
        ----------
        held : SX
            What it held before, (3, 1), body frame, m/s².
        first, last : SX
            The specific force at the beginning and the end, (3, 1), body frame, m/s².
        """
        early = 1 - self.accelerometer_kept - self.accelerometer_newest
        return self.accelerometer_kept * held + early * first + self.accelerometer_newest * last


@dataclass(frozen=True)
class HeadedSurroundings(FurtherSurroundings):
    """What there is besides with a compass.

    Attributes
    ----------
    heading_bias, heading_noise : SX
        rad.
    """

    heading_bias: ca.SX = scalar("rad")
    heading_noise: ca.SX = scalar("rad")


def of_vehicle(around: type[Surroundings], rotors: int, moments: int) -> type[Surroundings]:
    """Return the layout for so many rotors and moments.

    Parameters
    ----------
    around : type of Surroundings
        For four rotors and three moments.
    rotors : int
        Their number.
    moments : int
        Number of moments of inertia, with products of inertia if there are any.
    """
    of_each = ("rotor_min", "rotor_max", "rotor_shares")
    return resized(around, (("inertia", moments), *((name, rotors) for name in of_each)))


@dataclass(frozen=True)
class Features:
    """What a loop has beside its numbers, each a reason to compile another one.

    Attributes
    ----------
    camera_noise : bool
        Whether image points are noisy.
    rounded : bool
        Whether image coordinates are rounded.
    imu_noise : bool
        Whether gyro, velocity, gravity or accelerometer are noisy.
    gusts : bool
        Whether the wind has gusts.
    abort : bool
        Whether a flight ends when a target point leaves the view.
    turned : bool
        Whether the feature held is turned with the gyro until it is used.
    rotors_differ : bool
        Whether rotors or arms are not as the controller takes them to be.
    lag : bool
        Whether an accelerometer lags.
    lens : LensModel, optional
        What makes pixels of image points, and has edges; then noise and rounding are in px.
    """

    camera_noise: bool = False
    rounded: bool = False
    imu_noise: bool = False
    gusts: bool = False
    abort: bool = False
    turned: bool = False
    rotors_differ: bool = False
    lag: bool = False
    lens: LensModel | None = None

    def layout(self, law: Law, rotors: int = 4) -> dict[str, int]:
        """Return the parts of a vehicle's memory and their sizes, those of `LAYOUT` first.

        Parameters
        ----------
        law : Law
        rotors : int
            Their number.
        """
        turning = GYRO_LAYOUT if self.turned else {}
        lagging = ACCELEROMETER_LAYOUT if self.lags(law) else {}
        own = {"rotors": rotors, "rotor_commands": rotors}
        return LAYOUT | own | turning | lagging | (NORTH_LAYOUT if law.sees_north else {})

    def record(self, law: Law, rotors: int = 4) -> dict[str, int]:
        """Return the parts of a record and their sizes, those of `RECORD` first.

        Parameters
        ----------
        law : Law
        rotors : int
            Their number.
        """
        felt = {"specific_force": 3} if law.force.sensed else {}
        return RECORD | {"rotor_thrust": rotors, "rotor_command": rotors} | felt

    def surroundings(self, law: Law, rotors: int = 4) -> type[Surroundings]:
        """Return the layout of what surrounds a law.

        Parameters
        ----------
        law : Law
        rotors : int
            Their number.
        """
        further = FurtherSurroundings if self.rotors_differ or law.force.sensed else Surroundings
        kind = HeadedSurroundings if law.has_compass else further
        return of_vehicle(kind, rotors, law.design.sizes()["inertia"])

    def lags(self, law: Law) -> bool:
        """Tell whether an accelerometer has a memory.

        Parameters
        ----------
        law : Law
        """
        return self.lag and law.force.sensed is not None
