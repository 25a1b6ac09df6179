# SPDX-License-Identifier: MIT
"""Sets of bits and names that arrays hold as numbers."""
import enum


class StepWarning(enum.IntFlag):
    """Reasons to look at a step; each names the setting to raise."""

    COLLISION_LIMIT = 1 << 0  # collision_iterations ended stage 1 before it was quiet
    DYNAMIC_LIMIT = 1 << 1  # dynamic_iterations ended dynamic contact: the failsafe had to finish
    STATIC_LIMIT = 1 << 2  # a contact solve ended above its tolerance
    SCRIPT_DELAYED = 1 << 3  # a scripted body waited, as bodies are in its way or were of late
    REBOUND_LOST = 1 << 4  # a body that the failsafe held, or that was hit without end, lost a rebound


class ClusterState(enum.IntEnum):
    """How a body moved in a step; the values of `cluster` in World.activity and Frames.cluster."""

    FREE = 0
    KINEMATIC = 1  # with others, keeping their relative motion
    RIGID = 2  # as one rigid body with others
    HELD = 3  # not at all
    ASLEEP = 4  # not at all: it rests
    ABSENT = 255  # in Frames: it is not there, because an edit removed it or will add it
