"""P1 to P6: floors and aims of inverse kinematics, Jacobians and dynamics. Data only."""

from __future__ import annotations

from floor import Floor
from measures import MORE_TIME, P50, P99, SOLVED

BATCH = "inverse kinematics in one batch, cold, {robot}"
COLD = {"from C++": "inverse kinematics one by one, cold, C++, {robot}"}
COLD["from Python"] = "inverse kinematics one by one, cold, {robot}"
WARM = {"from C++": "inverse kinematics one by one, warm, C++, {robot}"}
WARM["from Python"] = "inverse kinematics one by one, warm, {robot}"
LEAST_SOLVED = 99.99  # percent of reachable poses, in the limits
SIX_JOINTS = ("desk6",)

BATCHES = (
    Floor(
        "P1",
        "IK in a batch, beside roboplan",
        "ik",
        BATCH,
        "roboplan",
        floor=80,
        aims={"AVX2": 250, "AVX-512": 600},
    ),
    Floor(
        "P1",
        "IK in a batch, beside TRAC-IK",
        "ik",
        BATCH,
        "TRAC-IK",
        floor=250,
        aims={"AVX2": 800, "AVX-512": 1500},
    ),
    Floor(
        "P1",
        "IK in a batch: solved, in the limits",
        "ik",
        BATCH,
        measure=SOLVED,
        floor=LEAST_SOLVED,
        aim=LEAST_SOLVED,
    ),
    Floor("P2", "IK in a batch, beside KDL-LMA", "ik", BATCH, "KDL-LMA", floor=60, aim=200),
    Floor(
        "P2",
        "IK in a batch, seven joints, beside EAIK with one held in turn",
        "ik",
        BATCH,
        "EAIK",
        floor=40,
        aim=120,
        not_meant=SIX_JOINTS,
    ),
    Floor("P5", "IK in a batch, beside mink", "ik", BATCH, "mink", floor=500, aim=2000),
    Floor("P5", "IK in a batch, beside Pinocchio", "ik", BATCH, "Pinocchio", floor=500, aim=2000),
    Floor(
        "P5",
        "1000 targets from Python, beside C++",
        "ik",
        "inverse kinematics in one batch, 1000 targets, Python, {robot}",
        "ours from C++",
        MORE_TIME,
        floor=1.02,
        aim=1.02,
    ),
)
SINGLES = (
    *(
        Floor("P3", f"one IK query, {language}, beside {peer}", "ik", name, peer, floor=f, aim=a)
        for peer, f, a in (("TRAC-IK", 100, 250), ("roboplan", 40, 100))
        for language, name in COLD.items()
    ),
    *(
        floor
        for language, name in COLD.items()
        for floor in (
            Floor("P3", f"one IK query, {language}: p50", "ik", name, measure=P50),
            Floor(
                "P3", f"one IK query, {language}: p99", "ik", name, measure=P99, floor=50, aim=15
            ),
            Floor(
                "P3",
                f"one IK query, {language}: solved, in the limits",
                "ik",
                name,
                measure=SOLVED,
            ),
        )
    ),
    *(
        floor
        for language, name in WARM.items()
        for floor in (
            Floor(
                "P4",
                f"one IK query from nearby, {language}, beside KDL-LMA",
                "ik",
                name,
                "KDL-LMA",
                floor=80,
                aim=200,
            ),
            Floor("P4", f"one IK query from nearby, {language}: p50", "ik", name, measure=P50),
            Floor("P4", f"one IK query from nearby, {language}: p99", "ik", name, measure=P99),
            Floor(
                "P4",
                f"one IK query from nearby, {language}: solved, in the limits",
                "ik",
                name,
                measure=SOLVED,
            ),
        )
    ),
)
QUANTITIES = ("tip and Jacobian", "gravity torques", "mass matrix")
DYNAMICS = (
    *(
        Floor(
            "P6",
            f"{quantity}, beside KDL",
            "dynamics",
            f"{quantity}, {{robot}}",
            "KDL",
            floor=5,
            aim=12,
        )
        for quantity in QUANTITIES
    ),
    *(
        Floor(
            "P6",
            f"{quantity} in a batch, beside Pinocchio in C++",
            "dynamics",
            f"{quantity}, batch, {{robot}}",
            "Pinocchio",
            floor=10,
            aims={"AVX2": 25, "AVX-512": 80},
        )
        for quantity in QUANTITIES
    ),
)
KINEMATICS = (*BATCHES, *SINGLES, *DYNAMICS)
