"""Sightings of a mission's tags as lines of JSON, for `hoverproof fly --features stdin`.

python sightings.py MISSION FAMILY:ID:SIZE [CAMERA [LATE]] | hoverproof fly MISSION ...

CAMERA is a number, a video or an image; LATE is how long before it comes here an image is exposed,
s. This is a process of its own, so that a detector that hangs or dies is an image that grows old:
the flight hands back. Needs OpenCV: pip install 'hoverproof[vision]'.
"""

import json
import sys
import time

import numpy as np

import hoverproof as hp
from hoverproof.eyes.sightings import Viewer
from hoverproof.eyes.video import open_source
from hoverproof.mission.tags import board_of_mission, board_of_tag
from hoverproof.plant.lens import seeing_lens

A_DAY = 86400.0

mission, tag = hp.load(sys.argv[1]), board_of_tag(sys.argv[2])
camera = sys.argv[3] if len(sys.argv) > 3 else "0"
late = float(sys.argv[4]) if len(sys.argv) > 4 else 0.02
lens = seeing_lens(mission)
if lens is None:
    sys.exit(f"{mission.name} has no [camera.lens]: give it that of your calibration")
viewer = Viewer(board_of_mission(mission, tag), *lens, mission)
for _, image in open_source(camera, duration=A_DAY if camera.isdigit() else None).images:
    exposed = time.time() - late
    pixels = viewer.corners(image, camera)
    seen = [] if np.isnan(pixels).any() else pixels.tolist()
    print(json.dumps({"time": exposed, "pixels": seen}), flush=True)
