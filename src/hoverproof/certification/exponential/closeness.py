"""How closely the ball of J is laid around what is sampled of it.

The closer it is, the faster errors are proved to fall, and the more cells it takes to show that J
does not leave it.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import replace

from hoverproof.certification.exponential.domain import Domain
from hoverproof.certification.exponential.question import Question
from hoverproof.mission.target import Target

CLOSE = 0.05, 0.1, 0.15, 0.2, 0.25, 0.3
"""By which shares the ball is widened, the first of them that takes few cells."""
FEW = 0.6
"""Few cells are this part of those that are checked: a check is to stay short."""


def is_shown(question: Question, target: Target, d: float, part: float = 1.0) -> bool:
    """Tell whether bounds of J are shown over the domain of a d with few enough cells.

    Parameters
    ----------
    question : Question
    target : Target
        The exact one, of the mission.
    d : float
        A bare number, dimensionless.
    part : float
        Of the cells that are checked, the part that it may take, dimensionless.
    """
    ball = question.ball(d)
    if ball is None:
        return False
    domain = Domain.of(question.scene, target, d, ball)
    tree = domain.tree(part=part)
    return tree is not None and tree.count("0") < part * domain.most_cells


def closest(question: Question, target: Target, d: float) -> Question | None:
    """Return a question with the closest ball that few cells show; None if it is no closer.

    Parameters
    ----------
    question : Question
    target : Target
        The exact one, of the mission.
    d : float
        That of what was found with the ball as it is, dimensionless.
    """
    asked = [replace(question, wider=wider) for wider in CLOSE if wider < question.wider]
    first = bisect_left(asked, True, key=lambda closer: is_shown(closer, target, d, FEW))
    return asked[first] if first < len(asked) else None
