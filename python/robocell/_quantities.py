"""Units and frames of features, as texts that episodes keep: which ones there are.

A dataset is read by others, for whom "metres" and "wrold" mean nothing.
"""

from __future__ import annotations

import re

from robocell._core import ArgumentError
from robocell._suggestions import did_you_mean

# Symbols without a prefix, and those of SI with one.
PLAIN = (
    *("1", "%", "min", "h", "d", "deg", "px", "dB", "L", "bar", "degC", "rpm", "byte", "tick"),
    "actuator",  # a control of an actuator's own, such as a gripper's 0..255
)
WITH_PREFIX = (
    *("m", "g", "s", "A", "K", "mol", "cd", "rad", "sr", "Hz", "N", "Pa", "J", "W", "C", "V", "F"),
    *("ohm", "S", "Wb", "T", "H", "lm", "lx", "eV", "Wh"),
)
PREFIXES = ("", "n", "u", "\u00b5", "m", "c", "d", "k", "M", "G")
SYMBOLS = frozenset([*PLAIN, *(prefix + unit for prefix in PREFIXES for unit in WITH_PREFIX)])
# Words that people write for symbols.
WORDS = {
    **dict.fromkeys(("metre", "metres", "meter", "meters"), "m"),
    **dict.fromkeys(("millimetre", "millimetres", "millimeter", "millimeters"), "mm"),
    **dict.fromkeys(("centimetre", "centimetres", "centimeter", "centimeters"), "cm"),
    **dict.fromkeys(("radian", "radians"), "rad"),
    **dict.fromkeys(("degree", "degrees", "\u00b0"), "deg"),
    **dict.fromkeys(("second", "seconds", "sec", "secs"), "s"),
    **dict.fromkeys(("millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("newton", "newtons"), "N"),
    **dict.fromkeys(("kilogram", "kilograms", "kgs"), "kg"),
    **dict.fromkeys(("gram", "grams"), "g"),
    **dict.fromkeys(("hertz", "hz"), "Hz"),
    **dict.fromkeys(("percent", "percents"), "%"),
    **dict.fromkeys(("pixel", "pixels"), "px"),
    **dict.fromkeys(("none", "unitless", "dimensionless", "bool", "count"), "1"),
    "Nm": "N m",
    "mps": "m/s",
}
EXAMPLES = (
    "'m', 'rad', 's', 'm/s', 'N m', 'kg m^2', '1' for numbers without a unit, 'm, 1' for both"
)

# One frame of the cell, or one of a robot or an element by its name.
FRAMES = ("world", "shared base frame")
FRAMES_OF = ("base of", "TCP of", "body", "site", "geom", "camera", "object")
FRAME_FORMS = "'world', 'shared base frame', 'base of rc7', 'TCP of rc7', \"body 'cup'\""


def require_units(call: str, units: str) -> None:
    """Raises ArgumentError for a unit that is not made of known symbols; "" is none."""
    if not isinstance(units, str):
        raise TypeError(f"{call}: `units` must be a text such as 'm', got {units!r}")
    for part in re.split(r"[\s*/,()\u00b7]+", units):
        symbol = re.sub(r"(?<=.)(\^?-?\d+|\u00b2|\u00b3)$", "", part)
        if symbol and symbol not in SYMBOLS:
            word = WORDS.get(symbol) or WORDS.get(symbol.lower())
            hint = f" Did you mean '{word}'?" if word else did_you_mean(symbol, sorted(SYMBOLS))
            raise ArgumentError(
                f"{call}: unit {units!r} has no known symbol {symbol!r}.{hint} Units are such as "
                f"{EXAMPLES}; `description` says what is counted"
            )


def require_frame(call: str, frame: str) -> None:
    """Raises ArgumentError for an unknown frame; "" means no frame."""
    if not isinstance(frame, str):
        raise TypeError(f"{call}: `frame` must be a text such as 'world', got {frame!r}")
    if not frame or frame in FRAMES:
        return
    if any(frame.startswith(kind + " ") and frame[len(kind) :].strip() for kind in FRAMES_OF):
        return
    raise ArgumentError(
        f"{call}: no frame {frame!r}.{did_you_mean(frame, FRAMES)} Frames are such as {FRAME_FORMS}"
    )
