"""The tool centre point: between the fingers, or where tools go on an arm without a hand."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from robocell._onboarding.guess import Confidence, Guess
from robocell._onboarding.hands import Fingers
from robocell._onboarding.limbs import Hand, Limb
from robocell._onboarding.source_model import SourceModel, Vector

# A site is the TCP of a hand when it is this near to the middle between the fingers, m, and its z
# axis points where they do, within this (cosine).
NEAR_THE_FINGERS = 0.03
ALONG = 0.9
# A site that is named as a tool frame may be farther along the fingers, at their tips or before
# them, but no farther beside the line on which they point, m.
ALONG_THE_FINGERS = 0.06
BESIDE_THE_LINE = 0.01
# Cosine of the angle between the last joint's axis and the way from it to the fingers.
ALONG_THE_ROLL = 0.8
MUCH, LITTLE = 0.02, 1e-3  # m
# Words in the names of sites that are tool frames, the most telling first.
WORDS = (
    "tcp",
    "pinch",
    "grasp",
    "grip",
    "eef",
    "ee",
    "end",
    "tool",
    "attach",
    "flange",
    "tip",
    "wrist",
)


@dataclass(frozen=True)
class Tcp:
    """The leaf of an arm: an element of the model, or a site that an edit adds."""

    leaf: dict[str, str]  # {"site": name} or {"body": name}
    edit: dict[str, object] | None = None
    in_world: Vector | None = None  # at the reference pose

    def __str__(self) -> str:
        (kind, name), *_ = self.leaf.items()
        return f"{kind} {name}"


def tcp_of_hand(
    source: SourceModel, hand: Hand, fingers: Fingers, approach: Vector, name: str
) -> Guess[Tcp]:
    """Returns a site of the hand between the fingers, or an added one.

    Args:
        source: The model.
        hand: The hand.
        fingers: Its fingers.
        approach: Where they point (`approach_of`).
        name: Of a site that has to be added.
    """
    best: tuple[float, int] | None = None
    others = []
    for site in _sites_fixed_to(source, hand.body):
        position, rotation = _in_body(source, hand.body, site)
        name_of_site = source.site_name(site)
        way = position - fingers.middle
        distance = float(np.linalg.norm(way))
        ahead = float(way @ approach)
        beside = float(np.linalg.norm(way - ahead * approach))
        is_tool = any(word in name_of_site.lower() for word in WORDS)
        is_on_line = beside < BESIDE_THE_LINE and abs(ahead) < ALONG_THE_FINGERS
        is_near = distance < NEAR_THE_FINGERS or (is_tool and is_on_line)
        if is_near and float(rotation[:, 2] @ approach) > ALONG:
            best = min(best or (distance, site), (distance, site))
        elif distance < 4 * NEAR_THE_FINGERS:
            others.append(f"{name_of_site} {1000 * distance:.0f} mm away")
    if best:
        site = best[1]
        return Guess(
            Tcp({"site": source.site_name(site)}, None, source.data.site_xpos[site]),
            f"{1000 * best[0]:.0f} mm from the middle between the fingers, its z where they point",
            Confidence.HIGH,
        )
    closing = _square_to(fingers.closing, approach)
    rotation = np.column_stack([np.cross(closing, approach), closing, approach])
    edit: dict[str, object] = {
        "add_site": name,
        "body": source.body_name(hand.body),
        "pos": rounded(fingers.middle),
        "xyaxes": rounded([*rotation[:, 0], *rotation[:, 1]]),
    }
    reason = "in the middle between the fingers, z where they point, y where they close"
    if others:
        reason += f" (no site of the model is near with these axes: {', '.join(others)})"
    at = source.data.xmat[hand.body].reshape(3, 3) @ fingers.middle + source.data.xpos[hand.body]
    return Guess(Tcp({"site": name}, edit, at), reason, Confidence.HIGH)


def approach_of(fingers: Fingers, wrist: Vector, axis: Vector | None = None) -> Vector:
    """Returns the direction of the fingers: away from the wrist, normal to their closing direction.

    Args:
        fingers: The fingers.
        wrist: End of the arm, in the frame of the hand's body.
        axis: Axis of the arm's last joint there. If it leads from the wrist to the fingers, they
            point along it: an arm of five joints can turn no other direction downwards.
    """
    away = fingers.middle - wrist
    if axis is not None and float(np.linalg.norm(away)) > MUCH:
        along = float(axis @ away) / float(np.linalg.norm(away))
        if abs(along) > ALONG_THE_ROLL:
            return np.asarray(np.sign(along) * axis)
    away = away - (away @ fingers.closing) * fingers.closing
    length = float(np.linalg.norm(away))
    if length > LITTLE:
        # Hands are built along an axis of their body, as a rule.
        away = away / length
        index = int(np.argmax(np.abs(away)))
        own = np.sign(away[index]) * np.eye(3)[index]
        square = abs(float(own @ fingers.closing)) < 0.2
        if square and float(away @ own) > 0.94:
            away = own - (own @ fingers.closing) * fingers.closing
            away = away / np.linalg.norm(away)
        return np.asarray(away)
    least = np.eye(3)[int(np.argmin(np.abs(fingers.closing)))]
    away = least - (least @ fingers.closing) * fingers.closing
    return np.asarray(away / np.linalg.norm(away))


def _square_to(vector: Vector, axis: Vector) -> Vector:
    """Returns the part of a vector that is normal to an axis, as a unit vector."""
    rest = vector - (vector @ axis) * axis
    return np.asarray(rest / max(float(np.linalg.norm(rest)), 1e-9))


def tcp_without_hand(source: SourceModel, limb: Limb, cup: int | None = None) -> Guess[Tcp]:
    """Returns the tool site at the end of an arm, its last link, or a suction cup's site."""
    last = source.data.xanchor[limb.joints[-1]]
    sites = _sites_fixed_to(source, limb.end)
    on_cup = [site for site in sites if int(source.model.site_bodyid[site]) == cup]
    if on_cup:
        tip = max(on_cup, key=lambda s: float(np.linalg.norm(source.data.site_xpos[s] - last)))
        name = source.site_name(tip)
        return Guess(
            Tcp({"site": name}, None, source.data.site_xpos[tip]),
            "the outermost site of the cup",
            Confidence.HIGH,
        )
    ranked = sorted(
        sites,
        key=lambda site: (
            _rank(source.site_name(site)),
            -float(np.linalg.norm(source.data.site_xpos[site] - last)),
        ),
    )
    if ranked:
        chosen, *others = (source.site_name(site) for site in ranked)
        sure = _rank(chosen) < len(WORDS)
        return Guess(
            Tcp({"site": chosen}, None, source.data.site_xpos[ranked[0]]),
            "a site on the last link" + (", by its name one for tools" if sure else ""),
            Confidence.HIGH if len(sites) == 1 or sure else Confidence.MEDIUM,
            tuple(Tcp({"site": other}) for other in others),
        )
    bodies = [body for body in source.rigid_with(limb.end) if source.is_below(body, limb.end)]
    farthest = max(
        bodies, key=lambda body: (float(np.linalg.norm(source.data.xpos[body] - last)), body)
    )
    return Guess(
        Tcp({"body": source.body_name(farthest)}, None, source.data.xpos[farthest]),
        "the last link has no site; this is its outermost body",
        Confidence.LOW,
        tuple(Tcp({"body": source.body_name(body)}) for body in bodies if body != farthest),
    )


def _rank(name: str) -> int:
    words = re.split(r"[^a-z]+", name.lower())
    for index, word in enumerate(WORDS):
        if word in words or (len(word) > 3 and word in name.lower()):
            return index
    return len(WORDS)


def _sites_fixed_to(source: SourceModel, body: int) -> list[int]:
    """Returns the sites of a body and of bodies fixed to it, farther from the base."""
    bodies = set(source.rigid_with(body))
    return [
        site for site in range(source.model.nsite) if int(source.model.site_bodyid[site]) in bodies
    ]


def _in_body(source: SourceModel, body: int, site: int) -> tuple[Vector, Vector]:
    d = source.data
    rotation = d.xmat[body].reshape(3, 3)
    position = rotation.T @ (d.site_xpos[site] - d.xpos[body])
    return position, rotation.T @ d.site_xmat[site].reshape(3, 3)


def rounded(values: object, digits: int = 5) -> list[float]:
    """Returns numbers for a file: no -0, and only significant digits."""
    return [round(float(value), digits) + 0.0 for value in np.asarray(values, dtype=float)]
