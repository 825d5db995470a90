"""Robot files made from models: what `robocell init` knows about MJCF and URDF.

    guess = detect(Path("arm.xml"), Path("arm_model.xml"), "arm")
    print(robot_text(guess, Path("arm.yaml")))

One file per idea: `roots`, `bases`, `limbs`, `hands`, `tcp`, `home`, `cameras`, `arm_control` each
read one part from the model, with reasons; `detect` combines them; `trial` loads the file and fixes
it.
"""

from robocell._onboarding.detect import detect
from robocell._onboarding.guess import Confidence, Guess
from robocell._onboarding.pick_run import (
    can_pick,
    objects_held,
    run_text,
    stand_in_reach,
)
from robocell._onboarding.prepared import model_text
from robocell._onboarding.robot_file import robot_text
from robocell._onboarding.robot_guess import RobotGuess
from robocell._onboarding.trial import Trial, tried

__all__ = [
    "Confidence",
    "Guess",
    "RobotGuess",
    "Trial",
    "can_pick",
    "detect",
    "model_text",
    "objects_held",
    "robot_text",
    "run_text",
    "stand_in_reach",
    "tried",
]
