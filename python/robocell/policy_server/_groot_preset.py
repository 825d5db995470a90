"""The preset that follows from the modalities of a GR00T server and the features of a cell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from robocell._core import Feature, NotFoundError
from robocell._groot_names import short_name
from robocell._placeholders import AS_RECORDED, OPENING
from robocell._policy_presets import Preset
from robocell._policy_presets.parts import Part
from robocell._suggestions import did_you_mean, shortened
from robocell._yaml import place_without_file

ACTION = "action"


def groot_preset(
    modalities: Mapping[str, Sequence[str]], features: Sequence[Feature], url: str
) -> Preset:
    """Returns the preset of a server that was trained on a dataset of `robocell export`.

    Raises:
        NotFoundError: The cell has no column for a part of the state or of an action.
    """
    columns = [each.name for each in features if each.name.startswith("robots/")]
    several = len({name.split("/")[1] for name in columns}) > 1
    commanded = [each.name for each in features if each.role == ACTION]
    seen = _by_short_name((name for name in columns if name not in commanded), several)
    acts = _by_short_name((name for name in columns if name in commanded), several)
    return Preset(
        name=url,
        files=(),
        observation={
            f"state>{name}": (Part(_column(seen, name, "state", url)),)
            for name in modalities["state"]
        },
        images={f"video>{name}": name for name in modalities["video"]},
        image_size=None,
        channels_first=False,
        prompt=f"language>{modalities['language'][0]}",
        actions=tuple(Part(_column(acts, name, ACTION, url)) for name in modalities[ACTION]),
        action_space="",
        gripper=AS_RECORDED,
        horizon=None,
        rate=None,
        place=place_without_file("preset", url),
    )


def _by_short_name(columns: Iterable[str], several: bool) -> dict[str, str]:
    """Returns columns by their short names; by whole ones too, as exports tell equal ones apart."""
    found: dict[str, str] = {}
    # The opening is the gripper of an export's state, before the joints of a group of that name.
    for column in sorted(columns, key=lambda name: not name.endswith(f"/{OPENING}")):
        found.setdefault(short_name(column, several), column)
        found[column.replace("/", "_")] = column
    return found


def _column(known: Mapping[str, str], name: str, modality: str, url: str) -> str:
    if name not in known:
        raise NotFoundError(
            f"policy server {url}: the cell has no column for its {modality} '{name}'."
            f"{did_you_mean(name, known)} It has: {shortened(sorted(known))}. A preset says which "
            f"column it is: --preset FILE.yaml with '{modality}>{name}'"
        )
    return known[name]
