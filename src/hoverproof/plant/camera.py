"""What the camera sees: pinhole image, spherical image, centroid and Q (eqs. 6-9)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from hoverproof.plant.rigid_body import direction_of, skew


def body_points(points: ca.SX, position: ca.SX, rotation: ca.SX) -> ca.SX:
    """Return the target points in the camera frame, Pᵢ = Rᵀ(P'ᵢ - ξ).

    Parameters
    ----------
    points : SX
        P', (3, n), world frame, m; one column a point.
    position : SX
        ξ, (3, 1), world frame, m.
    rotation : SX
        R, (3, 3), body to world.

    Returns
    -------
    SX, (3, n), camera frame, m
    """
    return rotation.T @ (points - ca.repmat(position, 1, points.shape[1]))


def pinhole(points: ca.SX) -> ca.SX:
    """Return the image points (X/Z, Y/Z) of a pinhole camera, (2, n), focal length 1.

    Parameters
    ----------
    points : SX
        P, (3, n), camera frame, m, in front of the camera (Z > 0).
    """
    return points[:2, :] / ca.repmat(points[2, :], 2, 1)


def spherical(image: ca.SX) -> ca.SX:
    """Return the unit vectors toward pinhole image points, (3, n).

    Parameters
    ----------
    image : SX
        (2, n), focal length 1.
    """
    return directions(ca.vertcat(image, ca.SX.ones(1, image.shape[1])))


def directions(points: ca.SX) -> ca.SX:
    """Return the unit vectors toward points anywhere about the camera, (3, n).

    Parameters
    ----------
    points : SX
        P, (3, n), camera frame, m.
    """
    return points / ca.repmat(ca.sqrt(ca.sum1(points * points)), 3, 1)


def centroid(directions: ca.SX, weights: Any = None) -> ca.SX:
    """Return the image centroid q = Σ wᵢ pᵢ, (3, 1) (eq. 7, where every wᵢ is 1).

    Parameters
    ----------
    directions : SX
        p, (3, n), unit vectors.
    weights : SX or (n,) numbers, optional
        How much each point counts; by default 1.
    """
    if weights is None:
        return ca.sum2(directions)
    return directions @ ca.SX(weights)


def spread(directions: ca.SX, centroid: ca.SX, weights: Sequence[float] | None = None) -> ca.SX:
    """Return W² - |q|² = W Σ wᵢ|pᵢ - q/W|², (1, 1), without cancellation where points are near.

    W is the sum of the weights: the number of points, if each counts once.

    Parameters
    ----------
    directions : SX
        p, (3, n), unit vectors.
    centroid : SX
        q, (3, 1), their weighted sum.
    weights : (n,) numbers, optional
        How much each point counts; by default 1.
    """
    n = directions.shape[1]
    if weights is None:
        return n * ca.sumsqr(directions - ca.repmat(centroid / n, 1, n))
    whole = sum(weights)
    apart = directions - ca.repmat(centroid / whole, 1, n)
    return whole * (ca.sum1(apart * apart) @ ca.SX(weights))


LOWEST = 1 / 32
"""Cosine to the vertical below which a point is taken to be seen, so that it stays a direction."""


def north(directions: ca.SX, gravity_direction: ca.SX, points: ca.SX) -> ca.SX:
    """Return the x axis of the world, Rᵀe₁, (3, 1), as a flat level target in its order tells it.

    With b the horizontal coordinates of the points less their mean, and h = p/(ρ·p) the level
    image, it is along Σ b₁ h - ρ × Σ b₂ h: the turn about the vertical that fits the level image
    to the pattern best, by least squares. It is exact wherever the camera is above the target, and
    however it is tilted, as long as each point is seen well below the horizon.

    Parameters
    ----------
    directions : SX
        p, (3, n), unit vectors, camera frame.
    gravity_direction : SX
        ρ = Rᵀe₃, (3, 1), likewise.
    points : SX
        Target, (3, n), world frame, m, of one z.
    """
    n = points.shape[1]
    flat = points[:2, :]
    flat -= ca.repmat(ca.sum2(flat) / n, 1, n)
    flat /= ca.sqrt(ca.sumsqr(flat))
    down = ca.fmax(gravity_direction.T @ directions, LOWEST)
    moments = (directions / ca.repmat(down, 3, 1)) @ flat.T
    along = moments[:, 0] - skew(gravity_direction) @ moments[:, 1]
    return direction_of(along)


def depth_matrix(points: ca.SX, weights: Any = None) -> ca.SX:
    """Return Q = Σ wᵢ (I - pᵢpᵢᵀ)/rᵢ, (3, 3), 1/m (eq. 9, where every wᵢ is 1).

    Parameters
    ----------
    points : SX
        P, (3, n), camera frame, m.
    weights : SX or (n,) numbers, optional
        How much each point counts; by default 1.
    """
    total = ca.SX.zeros(3, 3)
    for i in range(points.shape[1]):
        distance = ca.norm_2(points[:, i])
        p = points[:, i] / distance
        turned = (ca.SX.eye(3) - p @ p.T) / distance
        total += turned if weights is None else weights[i] * turned
    return total


def centroid_rate(centroid: ca.SX, rate: ca.SX, depth_flow: ca.SX) -> ca.SX:
    """Return q̇ = -Ω × q - y with the depth flow y = QV, (3, 1), 1/s (eq. 8).

    Parameters
    ----------
    centroid, rate : SX
        q and Ω, (3, 1), camera frame, 1 and rad/s.
    depth_flow : SX
        y = QV, (3, 1), 1/s: the only place where the unknown depths enter.
    """
    return -skew(rate) @ centroid - depth_flow
