"""What the camera sees: pinhole image, spherical image, centroid and Q (eqs. 6-9)."""

from __future__ import annotations

import casadi as ca

from hoverproof.plant.rigid_body import skew


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


def centroid(directions: ca.SX) -> ca.SX:
    """Return the image centroid q = Σ pᵢ, (3, 1) (eq. 7).

    Parameters
    ----------
    directions : SX
        p, (3, n), unit vectors.
    """
    return ca.sum2(directions)


def spread(directions: ca.SX, centroid: ca.SX) -> ca.SX:
    """Return n² - |q|² = n Σ|pᵢ - q/n|², (1, 1), without cancellation where the points are near.

    Parameters
    ----------
    directions : SX
        p, (3, n), unit vectors.
    centroid : SX
        q, (3, 1), their sum.
    """
    n = directions.shape[1]
    apart = directions - ca.repmat(centroid / n, 1, n)
    return n * ca.sumsqr(apart)


def depth_matrix(points: ca.SX) -> ca.SX:
    """Return Q = Σ (I - pᵢpᵢᵀ)/rᵢ, (3, 3), 1/m (eq. 9).

    Parameters
    ----------
    points : SX
        P, (3, n), camera frame, m.
    """
    total = ca.SX.zeros(3, 3)
    for i in range(points.shape[1]):
        distance = ca.norm_2(points[:, i])
        p = points[:, i] / distance
        total += (ca.SX.eye(3) - p @ p.T) / distance
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
