"""An arm as URDF, for peers that read nothing else: kinematics and limits of a PyKDL.Chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import PyKDL

ROTATIONS = (PyKDL.Joint.RotX, PyKDL.Joint.RotY, PyKDL.Joint.RotZ, PyKDL.Joint.RotAxis)
FIXED = (PyKDL.Joint.Fixed,)


def numbers(vector: Any) -> str:
    """Three numbers, to the bit."""
    return " ".join(repr(float(vector[i])) for i in range(3))


def origin(frame: Any) -> str:
    """A frame as URDF writes it."""
    return f'<origin xyz="{numbers(frame.p)}" rpy="{numbers(frame.M.GetRPY())}"/>'


def joint(name: str, kind: str, parent: str, child: str, inside: str) -> str:
    """A joint and the link that it moves."""
    return (
        f'<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/>{inside}</joint>'
    )


def urdf(chain: Any, limits: Sequence[Sequence[float]]) -> str:
    """From link `base` to link `tip`; joints are joint0, joint1, ..."""
    parts, parent, number = ['<link name="base"/>'], "base", 0
    for k in range(chain.getNrOfSegments()):
        segment = chain.getSegment(k)
        moving, tip = segment.getJoint(), segment.getFrameToTip()
        if moving.getType() not in FIXED:
            kind = "revolute" if moving.getType() in ROTATIONS else "prismatic"
            lower, upper = limits[number]
            at = moving.pose(0)
            parts.append(
                joint(
                    f"joint{number}",
                    kind,
                    parent,
                    f"moved{k}",
                    f'{origin(at)}<axis xyz="{numbers(moving.JointAxis())}"/>'
                    f'<limit lower="{lower!r}" upper="{upper!r}" effort="100" velocity="3"/>',
                )
            )
            parent, tip, number = f"moved{k}", at.Inverse() * tip, number + 1
        last = k + 1 == chain.getNrOfSegments()
        child = "tip" if last else f"link{k}"
        parts.append(joint(f"fixed{k}", "fixed", parent, child, origin(tip)))
        parent = child
    return f'<robot name="arm">{"".join(parts)}</robot>'
