"""What robocell wants to reach: floors that must be met, and aims. Data only.

Rows are called P1 to P21, as in README.md; ratios are to peers of the same run. verdicts.py judges
what RESULTS.md has of them.
"""

from __future__ import annotations

from dataclasses import replace

from floor import Floor
from kinematics_floors import KINEMATICS
from measures import MILLISECONDS, MORE_TIME, RATE, TIMES_AS_LONG

TRIALS = 375  # an hour: the most that RoboCasa and MimicGen publish

LOOPS = (
    *(
        Floor(
            "P7",
            f"control tick, {control}, beside bare `mj_step`",
            "control_loop",
            f"control tick, {control}, {{robot}}",
            "`mj_step`",
            MORE_TIME,
            floor=floor,
            aim=aim,
        )
        for control, floor, aim in (
            ("joint position", None, None),
            # Steps are the engine's own since decision 018, which costs two to three points.
            ("joint impedance", 1.08, 1.01),
            ("gravity torques", 1.08, 1.03),
            ("Cartesian impedance", 1.11, 1.03),
        )
    ),
    Floor(
        "P8",
        "step of an environment from Python, beside C++",
        "env_step",
        "step from Python, 33 of the engine, {robot}",
        "the same in C++, `Env::Step`",
        MORE_TIME,
        floor=1.05,
        aim=1.01,
    ),
    Floor(
        "P8",
        "step of an environment from Python, beside robosuite's Lift",
        "env_step",
        "step from Python, 33 of the engine, {robot}",
        "robosuite's Lift, Panda",
        floor=5,
        aim=7,
    ),
    Floor(
        "P8",
        "vector of environments on two threads, beside one",
        "env_step",
        "step in a vector on two threads, {robot}",
        "one thread",
        floor=1.85,
        aim=1.95,
    ),
)
SCENES = (
    Floor(
        "P9",
        "reset, beside one `mj_forward`",
        "reset",
        "reset with noise, {robot}",
        "one `mj_forward`",
        TIMES_AS_LONG,
        floor=3,
        aim=1.5,
    ),
    *(
        Floor(
            "P9",
            f"reset from Python, beside {peer}",
            "env_step",
            "reset from Python, {robot}",
            peer,
            floor=floor,
        )
        for peer, floor in (
            ("robosuite's Lift, soft", 30),
            ("robosuite's Lift, hard", 3000),
            ("FetchPickAndPlace-v4", 8),
        )
    ),
    Floor(
        "P10",
        "objects of the pool, beside `mj_recompile`",
        "add_remove",
        "object added or removed by pool, {robot}",
        "`mj_recompile`",
        floor=20,
        aim=1000,
    ),
    *(
        Floor(
            "P10",
            f"scene in a later process, beside {what}",
            "scene_again",
            "scene in a later process, {robot}",
            peer,
            floor=5,
            aim=10,
        )
        for what, peer in (
            ("compiling it", "the same scene compiled"),
            ("the engine reading it as XML", "the engine alone reads it as XML"),
        )
    ),
    *(
        Floor(
            "P11",
            f"colour, depth and segmentation, beside `mujoco.Renderer`, {how}",
            "render",
            "image of `soft`, {robot}",
            f"`mujoco.Renderer`, {how}",
            floor=floor,
            aim=aim,
        )
        for how, floor, aim in (("default", 50, 120), ("effects off", 12, 28))
    ),
    Floor(
        "P11",
        "the same with shadows and 4 samples, beside `mujoco.Renderer`, default",
        "render",
        "image of `soft`, shadows and 4 samples, {robot}",
        "`mujoco.Renderer`, default",
        floor=20,
        aim=40,
    ),
    Floor(
        "P11",
        "the same with shadows and 4 samples, beside rays on Embree",
        "render",
        "image of `soft`, shadows and 4 samples, {robot}",
        "rays on Embree with hard shadows",
        floor=2,
        aim=4,
    ),
)
EPISODES = (
    Floor(
        "P12",
        "images of episodes, beside the stages one after the other",
        "overlap",
        "an image of an episode, {robot}",
        "acting, images, encoding one after the other",
        floor=1.2,
        aim=1.8,
    ),
    Floor(
        "P12",
        "images of episodes, beside the slowest stage",
        "overlap",
        "an image of an episode, {robot}",
        "the slowest stage alone",
        TIMES_AS_LONG,
        aim=1.15,
    ),
    Floor(
        "P13",
        "pick episodes an hour, without cameras",
        "episodes",
        "pick episodes, {robot}, without cameras",
        measure=RATE,
        floor=30 * TRIALS,
        aim=30_000,
    ),
    Floor(
        "P14",
        "dataset writer, beside the bare encoders",
        "dataset_writer",
        "an image and its share of the rows, written, {robot}",
        "the bare encoders",
        MORE_TIME,
        floor=1.10,
        aim=1.03,
    ),
)
# Rows that RESULTS.md may lack, because their section was recorded before there was such a row, or
# because it needs a graphics card (P21, whose rates are those of an H100 with 16 cores). They are
# judged as soon as there is a record.
UNRECORDED = (
    Floor(
        "P12",
        "images of episodes, beside a Python pipeline, default renderer",
        "overlap",
        "an image of an episode, {robot}",
        "a Python pipeline",
        floor=5,
        aim=20,
    ),
    Floor(
        "P12",
        "images of episodes without effects, beside commit 8206dcb",
        "overlap",
        "an image of an episode without effects, {robot}",
        "commit 8206dcb as today's code does its work",
        floor=6,
        aim=15,
    ),
    *(
        Floor(
            "P14",
            f"dataset writer, beside {peer}",
            "dataset_writer",
            "an image and its share of the rows, written, {robot}",
            peer,
            floor=floor,
            aim=aim,
        )
        for peer, floor, aim in (("LeRobot 0.4.4", 8, 18), ("LeRobot's streaming", 2, 4.5))
    ),
    Floor(
        "P21",
        "image of `gl` in one process, beside `mujoco.Renderer`, effects off",
        "graphics_card",
        "image of `gl`, {robot}",
        "`mujoco.Renderer`, effects off",
        floor=1,
        aim=2,
    ),
    Floor(
        "P21",
        "images a second of 16 processes on one card",
        "graphics_card",
        "images of 16 processes, drawing service, {robot}",
        measure=RATE,
        floor=3600,
        aim=7500,
    ),
    Floor(
        "P21",
        "demo episodes an hour, 16 workers on one card",
        "graphics_card",
        "demo episodes, 16 workers, drawing service, {robot}",
        measure=RATE,
        floor=80_000,
        aim=200_000,
    ),
)
# These join FLOORS with the first record of their sections.
POLICIES = tuple(
    Floor(
        "P18",
        f"round trip to a policy server, {what}",
        "policy_round_trip",
        f"policy round trip, {what}, {{robot}}",
        measure=MILLISECONDS,
        floor=floor,
        aim=aim,
    )
    for what, floor, aim in (
        ("state only", 0.3, 0.1),
        ("state and two 224x224 images", 2.0, 0.7),
    )
)
MOTIONS = tuple(
    Floor(
        "P15",
        f"collision-aware plan, {name}, {family}",
        "motion",
        f"plan, {name}, {family}, {{robot}}",
        measure=MILLISECONDS,
        floor=floor,
        aim=(aim if "hard" in family or name != "median" else aim / 2),
    )
    for name, floor, aim in (("median", 2.0, 1.0), ("99th percentile", 50.0, 10.0))
    for family in (
        *("tabletop", "shelf", "box", "clutter"),
        *("hard tabletop", "hard shelf", "hard box", "hard clutter"),
    )
)
EXPORTS = (
    Floor(
        "P17",
        "frames exported as LeRobot v3.0 per second, two cameras 640x480",
        "export_lerobot",
        "frames exported as LeRobot v3.0, two cameras 640x480, {robot}",
        measure=RATE,
        floor=3000,
        aim=10_000,
    ),
    Floor(
        "P17",
        "frames exported, beside LeRobot's own writer",
        "export_lerobot",
        "frames exported as LeRobot v3.0, two cameras 640x480, {robot}",
        "lerobot==0.4.4",
        floor=10,
        aim=30,
    ),
)
AUGMENTATION = (
    *(
        Floor(
            "P19",
            f"kept episodes an hour of `robocell augment`, {name}",
            "augment",
            f"augmented {name} episodes, {{robot}}",
            measure=RATE,
            floor=10_000,
            aim=30_000,
        )
        for name in ("stack", "open")
    ),
    *(
        Floor(
            "P19",
            f"yield of `robocell augment`, {name}, %",
            "augment",
            f"yield of augmented {name}, {{robot}}",
            measure=RATE,
            floor=80,
            aim=90,
        )
        for name in ("stack", "open")
    ),
)
DAY = 270  # picks that a user of MolmoSpaces reports, with four workers
HOUSES = (
    *(
        Floor(
            "P16",
            what,
            "houses",
            f"{name}, {{robot}}",
            measure=MILLISECONDS,
            floor=floor,
            aim=aim,
        )
        for what, name, floor, aim in (
            ("a house with a robot, compiled", "house compiled", 2000, 500),
            ("the same in a later process", "house in a later process", 200, 50),
            ("reset of a house", "house reset", 10, 1),
        )
    ),
    *(
        Floor(
            "P16",
            f"pick episodes in houses an hour, {what}",
            "houses",
            f"pick episodes in houses, {{robot}}, {what}",
            measure=RATE,
            floor=floor,
            aim=aim,
        )
        for what, floor, aim in (
            ("without cameras", 30 * DAY / 24, 3000),
            ("with two cameras 320x240", 10 * DAY / 24, 1000),
        )
    ),
)
EVALUATIONS = tuple(
    Floor(
        "P18",
        f"actions of a policy that costs nothing, {what}, beside the environment alone",
        "evaluation_rate",
        f"actions of a policy that costs nothing, {what}, {{robot}}",
        "the environment alone",
        floor=floor,
        aim=aim,
    )
    # The environment alone keeps nothing either.
    for what, floor, aim in (("no rollouts kept", 0.9, 0.97), ("rollouts kept", None, 0.9))
)
# The same rows with the kernels of processors without AVX-512.
NARROWED = tuple(
    replace(floor, section=f"{floor.section}_avx2") for floor in KINEMATICS if floor.section
)
FLOORS = tuple(
    sorted(
        (*KINEMATICS, *NARROWED, *LOOPS, *SCENES, *EPISODES, *UNRECORDED),
        key=lambda floor: int(floor.row[1:]),
    )
)

# Peers that do a part of our work and nothing else: nobody is faster than they are.
BARE = (
    "`mj_step`",
    "one `mj_forward`",
    "the same in C++",
    "ours from C++",
    "the bare encoders",
)
