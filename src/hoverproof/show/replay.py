"""Draw what firmware would have commanded beside what was commanded."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from hoverproof.audit.replaying import Replay
from hoverproof.show.style import COLOURS, legend_above

WORDS = {
    "thrust": "thrust (N)",
    "torque": "torque (N m)",
    "rotor": "rotor thrust (N)",
    "throttle": "throttle (share)",
    "rate_command": "body rates (rad/s)",
}
POINTS = 3000


def replay_figure(replay: Replay) -> Figure:
    """Draw a panel for each output, the log's dashed, and when a limit was reached.

    Parameters
    ----------
    replay : Replay
    """
    rows = len(replay.outputs)
    figure = Figure(figsize=(9, 2.2 * rows), layout="constrained")
    step = max(1, len(replay.times) // POINTS)
    times = replay.times[::step]
    figure.suptitle(f"{replay.mission.name}: what its firmware commands, and what the log has")
    axes_of_all = np.ravel(figure.subplots(rows, 1, sharex=True, squeeze=False))
    labels = {"rotor": replay.mission.vehicle.frame.names}
    for axes, (name, values) in zip(axes_of_all, replay.outputs.items(), strict=True):
        theirs = replay.commanded.get(name)
        for i, part in enumerate(np.atleast_2d(values.T)):
            label = "firmware" if values.ndim == 1 else labels.get(name, "xyz")[i]
            colour = COLOURS[i % len(COLOURS)]
            axes.plot(times, part[::step], color=colour, lw=1, label=label)
        if theirs is not None:
            logged = np.atleast_2d(theirs.T).T[::step]
            lines = axes.plot(times, logged, color="black", lw=0.8, ls=":")
            lines[0].set_label("log")
        axes.set_ylabel(WORDS[name], fontsize=9)
        legend_above(axes)
    axes_of_all[-1].set_xlabel("time (s)")
    return figure
