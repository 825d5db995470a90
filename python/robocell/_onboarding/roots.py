"""Finds the bodies of a model's world that form the robot; others are floors, tables, objects."""

from __future__ import annotations

from dataclasses import dataclass

from robocell import SpecError
from robocell._onboarding.actuation import Actuation
from robocell._onboarding.bases import find_base
from robocell._onboarding.guess import Confidence, Guess, shortened
from robocell._onboarding.limbs import Anatomy, LimbKind, dissect
from robocell._onboarding.source_model import SourceModel


@dataclass(frozen=True)
class Roots:
    """The topmost bodies of one robot."""

    bodies: tuple[int, ...]
    names: tuple[str, ...]

    def __str__(self) -> str:
        return " and ".join(self.names)


def find_roots(source: SourceModel, actuation: Actuation) -> Guess[Roots]:
    """Returns the robot of a model: the bodies with actuators, else those with the most joints.

    Several roots with an arm each are one robot of several arms.
    """
    moving = [body for body in source.children(0) if _has_own_joints(source, body)]
    if not moving:
        raise SpecError(
            f"{source.path}: no body of the model has a hinge or a slide, so there is no robot in "
            f"it. Its bodies: {shortened([source.body_name(b) for b in source.children(0)])}. Give "
            "the file of the robot itself"
        )
    driven = [body for body in moving if _is_driven(source, actuation, body)]
    candidates = driven or moving
    anatomies = {body: anatomy_of(source, actuation, body) for body in candidates}
    armed = _bolted([body for body in candidates if _is_armed(anatomies[body])], source)
    chosen = armed or [max(candidates, key=lambda body: len(source.joints_below(body)))]
    others = [body for body in source.children(0) if body not in chosen]
    return Guess(
        _roots(source, chosen),
        _reason(source, chosen, bool(driven), others),
        Confidence.HIGH if len(moving) == len(chosen) or driven else Confidence.MEDIUM,
        tuple(_roots(source, [body]) for body in moving if [body] != chosen),
    )


def _bolted(bodies: list[int], source: SourceModel) -> list[int]:
    """Returns those that can be one robot: a body that floats is another robot than the rest."""
    fixed = [body for body in bodies if find_base(source, body).free_joint is None]
    if fixed or len(bodies) < 2:
        return fixed or bodies
    return [max(bodies, key=lambda body: len(source.joints_below(body)))]


def anatomy_of(source: SourceModel, actuation: Actuation, root: int) -> Anatomy:
    """Returns the parts of the robot below a root, without the joints of its base."""
    base = find_base(source, root)
    skipped = set(base.joints)
    if base.free_joint is not None:
        skipped.add(base.free_joint)
    return dissect(source, actuation, root, skipped)


def _roots(source: SourceModel, bodies: list[int]) -> Roots:
    return Roots(tuple(bodies), tuple(source.body_name(body) for body in bodies))


def _reason(source: SourceModel, chosen: list[int], driven: bool, others: list[int]) -> str:
    if not others and len(chosen) == 1:
        return "the only body of the model's world"
    which = "that actuators move" if driven else "with the joints"
    text = f"the only body {which}" if len(chosen) == 1 else f"the bodies {which}"
    if others:
        names = shortened([source.body_name(body) for body in others])
        text += f"; left out of the model's world: {names}"
    return text


def _has_own_joints(source: SourceModel, body: int) -> bool:
    return any(source.is_scalar(joint) for joint in source.joints_below(body))


def _is_driven(source: SourceModel, actuation: Actuation, body: int) -> bool:
    cups = [a.body for a in actuation.actuators if a.body is not None]
    return any(actuation.is_moved(joint) for joint in source.joints_below(body)) or any(
        source.is_below(cup, body) for cup in cups
    )


def _is_armed(anatomy: Anatomy) -> bool:
    return any(limb.kind is LimbKind.ARM or limb.hand for limb in anatomy.limbs)
