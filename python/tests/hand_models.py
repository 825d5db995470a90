"""Hands with many joints, made up for tests."""

from __future__ import annotations

from init_models import SIX_GAINS, model, servos, six_axis

PALM = "<geom type='box' size='.045 .02 .05' pos='0 0 -.05' mass='.4'/>"


def finger(name: str, at: str, lengths: list[float], *, spread: str = "0 1 0") -> str:
    """A finger along z whose first joint turns it about `spread`, and the others curl it.

    Positive angles curl it towards y.
    """
    text = (
        f"<body name='{name}_base' pos='{at}'>"
        f"<joint name='{name}0' axis='{spread}' range='-.4 .4' damping='.05' armature='.002'/>"
        "<geom type='sphere' size='.008' mass='.02'/>"
    )
    below = "0 0 .01"
    for index, length in enumerate(lengths, 1):
        text += (
            f"<body name='{name}_{index}' pos='{below}'>"
            f"<joint name='{name}{index}' axis='-1 0 0' range='-.3 1.6' damping='.05' "
            "armature='.002'/>"
            f"<geom type='capsule' fromto='0 0 0 0 0 {length}' size='.008' mass='.02' contype='1' "
            "conaffinity='1' friction='1.5' condim='4'/>"
        )
        below = f"0 0 {length}"
    return text + "</body>" * (len(lengths) + 1)


def hand(prefix: str = "", fingers: int = 3) -> tuple[str, dict[str, tuple[float, float]]]:
    """A palm with parallel fingers and a thumb across; returns the servos' ranges by joint."""
    p = prefix
    places = [(index - (fingers - 1) / 2) * 0.03 for index in range(fingers)]
    body = f"<body name='{p}palm' pos='0 0 .16'>{PALM}"
    ranges: dict[str, tuple[float, float]] = {}
    for index, x in enumerate(places):
        name = f"{p}f{index}_"
        body += finger(name, f"{x} -.035 0", [0.04, 0.03, 0.025])
        ranges |= {f"{name}0": (-0.4, 0.4)} | {f"{name}{j}": (-0.3, 1.6) for j in (1, 2, 3)}
    thumb = finger(f"{p}th_", "0 0 0", [0.04, 0.03, 0.025])
    body += f"<body name='{p}mount' pos='0 .04 0' euler='0 0 3.14159265'>{thumb}</body></body>"
    ranges |= {f"{p}th_0": (-0.4, 0.4)} | {f"{p}th_{j}": (-0.3, 1.6) for j in (1, 2, 3)}
    return body, ranges


def hand_servos(ranges: dict[str, tuple[float, float]]) -> str:
    """A position servo on each joint."""
    return "".join(
        f"<position name='m_{joint}' joint='{joint}' kp='3' kv='.1' ctrlrange='{low} {high}'/>"
        for joint, (low, high) in ranges.items()
    )


def many_fingered_hand(fingers: int = 3, keys: str = "") -> str:
    """A hand alone."""
    body, ranges = hand(fingers=fingers)
    rest = f"<actuator>{hand_servos(ranges)}</actuator>"
    if keys:
        rest += f"<keyframe>{keys}</keyframe>"
    return model("many", body, rest)


def arm_with_many_fingered_hand() -> str:
    """A six-axis arm that carries such a hand."""
    body, ranges = hand()
    drives = servos(SIX_GAINS) + hand_servos(ranges)
    return model("dex", six_axis(body), f"<actuator>{drives}</actuator>")
