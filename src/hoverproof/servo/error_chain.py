"""The paper's error chain, by the names that the proofs of its law take it by."""

from __future__ import annotations

from hoverproof.servo.law import Design as Design
from hoverproof.servo.law import Errors as Errors
from hoverproof.servo.law import Measurement as Measurement
from hoverproof.servo.law import measured_rate as measured_rate
from hoverproof.servo.laws.hamel_mahony import errors as errors
