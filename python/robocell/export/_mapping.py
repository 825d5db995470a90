"""Which columns of an episode make up each feature of a training dataset, as written in YAML.

Every format has a table of its own; a preset and a file of the user replace entries of it.
`Mapping.resolve` applies the table to one episode.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from robocell._core import ArgumentError, Episode, NotFoundError, SpecError
from robocell._placeholders import (
    AS_RECORDED,
    Column,
    Gripper,
    Groups,
    Openings,
    camera_of,
    expanded,
    first_of,
    groups_of,
    openings_of,
    require_column,
    require_placeholders,
)
from robocell._preset_fields import gripper_of, image_size_of
from robocell._suggestions import did_you_mean, shortened
from robocell._yaml import Place
from robocell.export._features import DONE, Feature, Resolved, Term, feature_of
from robocell.export._table import (
    built_in_table,
    chosen_action,
    listed_actions,
    merge_table,
    read_preset,
    read_table,
    require_apart,
    require_names,
    template_of,
    terms_of,
)

OF_NAMES = ("{n}", "{group}", "{arm}")  # placeholders of names of features


@dataclass(frozen=True)
class Mapping:
    """The table of features.

    Attributes:
        place: The files that the table was read from; it begins error messages.
        features: Columns of each feature, as patterns.
        actions: Ready-made columns of the actions, by name.
        images: Camera of each image feature, as patterns.
        task: Entry of an episode's metadata that holds the instruction.
        text: An instruction that replaces it.
        template: Name of the image feature of a camera, with {camera} in it; "" where a preset
            names its cameras.
        image_size: Width and height of exported images; None for those of the episodes.
        gripper: The numbers of open and closed grippers.
        cameras: The cameras that `images` may choose from; None for all.
        own: Features that a preset, a file or the user names; each must have a column.
    """

    place: Place
    features: dict[str, list[Term]]
    actions: dict[str, list[Term]]
    images: dict[str, str]
    task: str
    text: str | None = None
    template: str = ""
    image_size: tuple[int, int] | None = None
    gripper: Gripper = AS_RECORDED
    cameras: tuple[str, ...] | None = None
    own: frozenset[str] = frozenset()

    @classmethod
    def load(
        cls,
        file: Path | None = None,
        actions: str | None = None,
        *,
        table: str = "lerobot.yaml",
        preset: str | None = None,
        reserved: Sequence[str] = (),
    ) -> Mapping:
        """Reads the table of a format, with the entries of a preset and a file in place of its own.

        Args:
            file: YAML file with any of the fields of the built-in table.
            actions: A name of `actions`, or columns separated by commas; it replaces the feature
                of the actions.
            table: Name of the built-in table.
            preset: Name of a built-in preset, or a YAML file; its features and images replace all
                those of the table.
            reserved: Arrays and groups of arrays that the format writes itself.

        Raises:
            SpecError: A file is not such a table.
            NotFoundError: There are no actions or no preset of this name.
        """
        whole, place = built_in_table(table)
        template = template_of(whole["images"])
        wanted: set[str] = set()
        if preset is not None:
            own, place_of_own = read_preset(preset)
            place, template = place_of_own.over(place), ""
            wanted |= merge_table(whole, own, place_of_own, replaces=True)
        if file is not None:
            own, place_of_own = read_table(file)
            place = place_of_own.over(place)
            wanted |= merge_table(whole, own, place_of_own, replaces=False)
        choices = {
            name: terms_of(whole["actions"], name, place.at("actions")) for name in whole["actions"]
        }
        chosen = whole.get("action_feature", "action")
        if not isinstance(chosen, str | None):
            raise SpecError(
                f"{place.at('action_feature')} is the name of a feature, got {chosen!r}"
            )
        if actions is not None and chosen is None:
            raise ArgumentError(
                f"{place} has actions of several kinds; '{actions}' has nothing to choose"
            )
        if actions is not None:
            whole["features"][chosen] = (
                actions if actions in choices else listed_actions(actions, choices)
            )
            wanted.add(str(chosen))
        features = {}
        for name, columns in whole["features"].items():
            if isinstance(columns, str) and name == chosen:
                features[name] = chosen_action(columns, choices, place.at("features", name))
            elif columns is not None:
                features[name] = terms_of(whole["features"], name, place.at("features"))
        require_names(features, place.at("features"))
        require_names(whole["images"] or {}, place.at("images"))
        _require_words(features, choices, whole["images"] or {}, place)
        named = [("features", name) for name in features]
        named += [("images", name) for name in whole["images"] or {}]
        for field, name in named:
            if any(name == each or name.startswith(f"{each}/") for each in reserved):
                raise SpecError(
                    f"{place.at(field, name)} is written by the export itself; choose another name"
                )
        task = whole["task"]
        text = task.get("text") if isinstance(task, dict) else None
        if not isinstance(text if isinstance(task, dict) else task, str):
            raise SpecError(
                f"{place.at('task')} is an entry of the metadata, 'instruction', or {{text: 'a "
                f"sentence'}}; got {task!r}"
            )
        return cls(
            place,
            features,
            choices,
            dict(whole["images"] or {}),
            "" if text else str(task),
            text,
            template,
            image_size_of(whole.get("image_size"), place, even=True),
            gripper_of(whole.get("gripper"), place),
            own=frozenset(wanted),
        )

    def only_cameras(self, cameras: Sequence[str]) -> Mapping:
        """Returns the table with only these cameras, each under the format's own name for it.

        A preset keeps its names, and chooses from these cameras.
        """
        if not self.template:
            return replace(self, cameras=tuple(cameras), images=self.images if cameras else {})
        return replace(
            self, images={self.template.replace("{camera}", name): name for name in cameras}
        )

    def resolve(self, episode: Episode) -> Resolved:
        """Applies the table to an episode.

        Raises:
            NotFoundError: The episode has no such column or camera; the message has the nearest.
            ArgumentError: A column cannot be a feature.
        """
        openings = openings_of(_described(episode))
        groups = self._groups(episode, openings)
        robots = list(groups)
        known = [*_step_columns(episode), DONE]
        features: list[Feature] = []
        for name, entries in self.features.items():
            before = len(features)
            for own_name, columns, of_robots in _named(name, entries, groups):
                terms = self._expand(episode, own_name, columns, of_robots, known)
                if terms:
                    features.append(
                        feature_of(episode, own_name, terms, robots, self.gripper, openings.columns)
                    )
            if name in self.own and len(features) == before:
                self._require_optional(episode, name, entries, known)
        images = self._images(episode)
        require_apart([*(feature.name for feature in features), *images], self.place)
        return Resolved(
            features=tuple(features),
            images=images,
            task=self._task(episode),
            robots=tuple(robots),
        )

    def _groups(self, episode: Episode, openings: Openings) -> dict[str, Groups]:
        """Returns the robots of an episode with their arms and grippers, in the order of the run.

        Raises:
            ArgumentError: Nothing says which group a command of the episode belongs to, and the
                table has no column of its own for it.
        """
        columns = set(episode.columns)
        in_order = dict.fromkeys([*(f.name for f in episode.features), *episode.columns])
        commands = [name for name in in_order if name in columns]
        found = groups_of(commands, openings.columns)
        known = {
            f"robots/{robot}/action/{group}"
            for robot, own in found.items()
            for group in own.arms
            if not columns.isdisjoint(f"robots/{robot}/{group}/{x}" for x in ("qpos", "target"))
        } | openings.columns
        terms = [term.column for entries in self.features.values() for term in entries]
        if any("/action/{" in column for column in terms):
            place = f"{self.place}: episode '{episode.folder}'"
            _require_clear(place, openings, terms)
            _require_positions(place, found, known, terms)
        return groups_of([name for name in commands if name in known], openings.columns)

    def _expand(
        self,
        episode: Episode,
        feature: str,
        entries: list[Term],
        groups: dict[str, Groups],
        known: list[str],
    ) -> list[Term]:
        terms: dict[Term, None] = {}
        repeated = [entry.column for entry in entries if "{" in entry.column]
        if repeated and not groups:
            place = self.place.at("features", feature)
            raise NotFoundError(
                f"{place}: episode '{episode.folder}' has no robots with actions, as "
                f"'{repeated[0]}' needs. Name its columns in a file: --mapping FILE"
            )
        for entry, name in expanded(entries, groups):
            place = self.place.at("features", feature).near(entries.index(entry))
            for column in self._find(episode, place, name, known):
                terms[replace(entry, column=column)] = None
        return list(terms)

    def _require_optional(
        self, episode: Episode, feature: str, entries: list[Term], known: list[str]
    ) -> None:
        """Raises NotFoundError for a feature without a column, unless it may be left out."""
        for entry in entries:
            if not entry.column.endswith("?"):
                place = self.place.at("features", feature)
                raise NotFoundError(
                    f"{place}: episode '{episode.folder}' has no column for '{entry.column}': "
                    "its robots have no such group. Its columns: "
                    f"{shortened(_nearest_first(entry.column, known))}. '{entry.column}?' may be "
                    "left out"
                )

    def _find(self, episode: Episode, at: Place, entry: str, known: list[str]) -> list[str]:
        """Returns the columns of one entry, without placeholders."""
        if found := first_of(entry, known):
            return found
        if entry.endswith("?"):
            return []
        place = f"{at}: episode '{episode.folder}'"
        name = entry.split("|")[0]
        if name in episode.columns:
            table = episode.column(name).table
            what = f"is of table '{table}'" if table else "is a constant"
            raise ArgumentError(f"{place}: '{name}' {what}; features are columns of table 'steps'")
        raise NotFoundError(
            f"{place} has no column '{name}'.{did_you_mean(name, known)} Its columns: "
            f"{shortened(_nearest_first(name, known))}"
        )

    def _images(self, episode: Episode) -> dict[str, str]:
        images: dict[str, str] = {}
        every = episode.cameras
        for name in self.cameras or ():
            if name not in every:
                raise NotFoundError(
                    f"episode '{episode.folder}' has no camera '{name}' with colour images."
                    f"{did_you_mean(name, every)} Its cameras: {', '.join(every) or 'none'}"
                )
        there = [name for name in every if self.cameras is None or name in self.cameras]
        for feature, camera in self.images.items():
            if "{camera}" in feature:
                images |= {feature.replace("{camera}", name): name for name in there}
                continue
            found = camera_of(camera, there, images.values())
            if found is not None:
                images[feature] = found
            elif not camera.endswith("?"):
                name = camera.split("|")[0]
                raise NotFoundError(
                    f"{self.place.at('images', feature)}: episode '{episode.folder}' has no camera "
                    f"'{name}' with colour images.{did_you_mean(name, there)} Its cameras: "
                    f"{', '.join(there) or 'none'}"
                )
        described: Any = episode.json
        for camera in images.values():
            table = described["cameras"][camera].get("table", "steps")
            if table != "steps":
                raise ArgumentError(
                    f"episode '{episode.folder}': the frames of camera '{camera}' are of table "
                    f"'{table}', so frame i is not row i of the steps. Leave it out: --cameras"
                )
        return images

    def _task(self, episode: Episode) -> str:
        if self.text is not None:
            return self.text
        metadata: Any = episode.metadata or {}
        task = metadata.get(self.task)
        if isinstance(task, str) and task:
            return task
        if task == "":
            raise NotFoundError(
                f"{self.place.at('task')}: '{self.task}' of episode '{episode.folder}' is empty. A "
                'mapping file with `task: {text: "..."}` gives one'
            )
        texts = [name for name, value in metadata.items() if isinstance(value, str)]
        raise NotFoundError(
            f"{self.place.at('task')}: the metadata of episode '{episode.folder}' has no text "
            f"'{self.task}'.{did_you_mean(self.task, texts)} Its texts: "
            f'{shortened(texts) or "none"}. A mapping file with `task: {{text: "..."}}` gives one'
        )


def _require_words(
    features: dict[str, list[Term]],
    choices: dict[str, list[Term]],
    images: dict[str, str],
    place: Place,
) -> None:
    """Raises SpecError for a placeholder that stands for nothing."""
    for name in features:
        require_placeholders(str(name), place.at("features").near(name), OF_NAMES)
        if sum(each in str(name) for each in OF_NAMES) > 1:
            raise SpecError(
                f"{place.near('features', name)}: '{name}' has several of "
                f"{', '.join(OF_NAMES)}; one is allowed"
            )
    for field, table in (("features", features), ("actions", choices)):
        for name, terms in table.items():
            more = [
                each for each in ("{group}", "{arm}") if field == "features" and each in str(name)
            ]
            for index, term in enumerate(terms):
                require_column(term.column, place.at(field, name, index), more)
    for name, camera in images.items():
        require_placeholders(name, place.at("images").near(name), ["{camera}"])
        allowed = ["{camera}"] if "{camera}" in name else []
        require_placeholders(camera, place.at("images", name), allowed)


def _named(
    feature: str, entries: list[Term], groups: dict[str, Groups]
) -> Iterator[tuple[str, list[Term], dict[str, Groups]]]:
    """Yields a feature with its columns and robots.

    {n} in its name makes a feature of each robot, {group} and {arm} one of each group or arm.
    """
    if "{n}" in feature:
        for index, robot in enumerate(groups):
            yield feature.replace("{n}", str(index)), entries, {robot: groups[robot]}
        return
    placeholder = next((each for each in ("{group}", "{arm}") if each in feature), None)
    if placeholder is None:
        yield feature, entries, groups
        return
    for robot, own in groups.items():
        for group in own.arms if placeholder == "{arm}" else (*own.arms, *own.grippers):
            name = f"{robot}_{group}" if len(groups) > 1 else group
            columns = [replace(e, column=e.column.replace(placeholder, group)) for e in entries]
            yield feature.replace(placeholder, name), columns, {robot: own}


def _described(episode: Episode) -> dict[str, Column]:
    described = {name: episode.column(name) for name in episode.columns}
    return {
        name: Column(int(np.prod(each.row_shape)), tuple(each.names), each.units)
        for name, each in described.items()
    }


def _is_named(column: str, terms: Sequence[str]) -> bool:
    """Returns True if a table has an entry of its own for a column."""
    return any(first_of(term, [column]) for term in terms)


def _require_clear(place: str, openings: Openings, terms: Sequence[str]) -> None:
    """Raises ArgumentError for a robot of whose commands several may be the gripper's."""
    for robot, commands in openings.unclear.items():
        if not any(_is_named(name, terms) for name in commands):
            names = ", ".join(f"'{name}'" for name in commands)
            raise ArgumentError(
                f"{place}: robot '{robot}' has a gripper, 'robots/{robot}/opening', and nothing "
                f"says whether {names} commands it. Record the gripper's command with "
                'ColumnSpec(names=["opening"]) and those of joints with their units, or name the '
                "columns in a file: --mapping FILE"
            )


def _require_positions(
    place: str, groups: dict[str, Groups], known: Collection[str], terms: Sequence[str]
) -> None:
    """Raises ArgumentError for a command of a group of which nothing else was recorded."""
    for robot, own in groups.items():
        for group in own.arms:
            command = f"robots/{robot}/action/{group}"
            if command not in known and not _is_named(command, terms):
                raise ArgumentError(
                    f"{place}: '{command}' belongs to no group: there is no "
                    f"'robots/{robot}/{group}/qpos' and no 'robots/{robot}/{group}/target'. Record "
                    'them; or, for the opening of a gripper, ColumnSpec(names=["opening"]). '
                    "--mapping FILE names other columns"
                )


def _step_columns(episode: Episode) -> list[str]:
    return [name for name in episode.columns if episode.column(name).table == "steps"]


def _nearest_first(name: str, known: Sequence[str]) -> list[str]:
    """Returns the names, those that share the longest beginning with `name` first."""

    def shared(other: str) -> int:
        pairs = zip(name, other, strict=False)
        return sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], pairs))

    return sorted(known, key=shared, reverse=True)
