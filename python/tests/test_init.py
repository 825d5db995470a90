"""`robocell init` as people use it: the files that it writes load and are checked."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

import init_models
import robocell
import robot_models
from command_line import refused, robocell_command

LFS_POINTER = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a21\nsize 12345\n"


def init(folder: Path, text: str, *options: object, name: str = "arm.xml") -> dict:
    """Runs it on a model in a folder of its own; the robot file as plain data."""
    model = folder / name
    model.write_text(text)
    result = robocell_command("init", model, "-o", folder / "out.yaml", *options)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    return yaml.safe_load((folder / "out.yaml").read_text())


def kinds(written: dict) -> dict[str, str]:
    return {name: group["kind"] for name, group in written["move_groups"].items()}


class TestRobots:
    def test_an_arm_with_a_hand_that_an_equality_closes(self, tmp_path: Path):
        written = init(tmp_path, init_models.arm_with_hand())
        assert kinds(written) == {"arm": "arm", "gripper": "gripper"}
        assert written["root_body"] == "base"
        assert written["base"]["kind"] == "mocap"
        arm, gripper = written["move_groups"]["arm"], written["move_groups"]["gripper"]
        assert arm["joints"] == "j1..j6"
        assert arm["actuators"] == "m_j1..m_j6"
        assert gripper["actuators"] == ["grip"]
        assert gripper["fingers"] == [{"body": "left_finger"}, {"body": "right_finger"}]
        assert written["home"]["gripper"] == [0.03, 0.03]
        # Between the pads, which are 20 to 80 mm above the hand, looking away from the wrist.
        (edit,) = written["edits"]
        assert edit["body"] == "hand"
        assert edit["pos"] == pytest.approx([0, 0, 0.08], abs=0.005)
        assert [camera["name"] for camera in written["cameras"]] == ["wrist_camera", "exo_camera"]

    def test_the_generated_file_gives_the_measured_gripper_range(self, tmp_path: Path):
        init(tmp_path, init_models.arm_with_hand())
        ranges = robocell_command("gripper-range", tmp_path / "out.yaml").stdout
        assert "0.002 - 0.062" in ranges

    def test_a_scara_starts_away_from_its_limits(self, tmp_path: Path):
        written = init(tmp_path, init_models.scara())
        arm = written["move_groups"]["arm"]
        assert arm["joints"] == "j1..j4"
        assert arm["leaf"] == {"site": "tool"}
        slide = written["home"]["arm"][2]
        assert -0.15 + written["home_noise"]["arm"][2] <= slide
        assert slide <= -written["home_noise"]["arm"][2]

    def test_a_desktop_arm_with_one_jaw(self, tmp_path: Path):
        written = init(tmp_path, init_models.desktop_arm())
        assert written["move_groups"]["arm"]["joints"] == ["pan", "lift", "elbow", "flex", "roll"]
        gripper = written["move_groups"]["gripper"]
        assert gripper["joints"] == ["jaw"]
        # Measured at the tips: near its hinge a jaw opens hardly at all.
        sites = {edit["add_site"]: edit for edit in written["edits"] if "add_site" in edit}
        tips = [sites[finger["site"]] for finger in gripper["fingers"]]
        assert {tip["body"] for tip in tips} == {"jaw_fixed", "jaw_moving"}
        assert "size" not in written["base"]  # small enough for the table

    def test_a_mobile_base_keeps_its_joints(self, tmp_path: Path):
        written = init(tmp_path, init_models.mobile_arm())
        assert written["root_body"] == "car"
        assert written["move_groups"]["base_joints"]["joints"] == ["x", "y", "yaw"]
        assert written["move_groups"]["arm"]["joints"] == "j1..j6"

    def test_two_arms_on_a_torso(self, tmp_path: Path):
        written = init(tmp_path, init_models.torso())
        assert kinds(written) == {
            "left_arm": "arm",
            "left_gripper": "gripper",
            "right_arm": "arm",
            "right_gripper": "gripper",
            "torso": "generic",
        }
        assert written["root_body"] == "chest"
        assert written["move_groups"]["torso"]["joints"] == ["waist"]

    @pytest.mark.proof
    def test_two_adjacent_arms_become_one_robot(self, tmp_path: Path):
        written = init(tmp_path, init_models.two_arms_apart())
        assert written["model"] == "out_model.xml"
        assert [name for name, kind in kinds(written).items() if kind == "arm"] == [
            "left_arm",
            "right_arm",
        ]
        made = (tmp_path / "out_model.xml").read_text()
        assert "cube" not in made
        assert made.startswith("<!-- Made from arm.xml by `robocell init`")

    def test_a_hand_without_an_arm_stays_at_its_task_pose(self, tmp_path: Path):
        written = init(tmp_path, init_models.hand_alone())
        assert kinds(written) == {"gripper": "gripper"}
        assert written["edits"][0]["delete"] == {"joint": "hand:joint0"}
        assert written["base"] == {"kind": "mocap"}

    def test_a_suction_cup_is_a_gripper(self, tmp_path: Path):
        written = init(tmp_path, init_models.suction_arm())
        assert kinds(written) == {"arm": "arm", "gripper": "gripper"}
        assert written["move_groups"]["arm"]["leaf"] == {"site": "tip"}
        gripper = written["move_groups"]["gripper"]
        assert gripper == {"kind": "gripper", "actuators": ["suck"], "leaf": {"site": "tip"}}
        assert "suction cups and magnets" in (tmp_path / "out.yaml").read_text()
        assert "NOTE" not in (tmp_path / "out.yaml").read_text()

    @pytest.mark.proof  # an arm with a gripper picks below
    def test_a_suction_cup_picks(self, tmp_path: Path):
        init(tmp_path, init_models.suction_arm())
        done = robocell_command(
            "generate",
            tmp_path / "out_pick.yaml",
            "--episodes",
            "3",
            "--workers",
            "1",
            "--set",
            "cameras.streams=[]",
            cwd=tmp_path,
        )
        assert done.returncode == 0, done.stderr
        # Nothing sticks to a ball.
        run = yaml.safe_load((tmp_path / "out_pick.yaml").read_text())
        assert "sphere" not in run["task"]["objects"]

    def test_motors_without_inertia_get_the_armature_that_check_names(self, tmp_path: Path):
        written = init(tmp_path, init_models.arm_of_motors_without_inertia())
        joints = [edit["joint"] for edit in written["edits"] if set(edit) == {"joint", "armature"}]
        assert "j6" in joints
        assert len(joints) == len(set(joints)) == len(written["edits"])
        text = (tmp_path / "out.yaml").read_text()
        words = text.replace("#", " ").split()
        assert "Does the model leave out the inertia of the motors?" in " ".join(words)
        assert "armature" not in robocell_command("check", tmp_path / "out.yaml").stdout

    def test_an_arm_without_a_hand_shows_how_to_mount_one(self, tmp_path: Path):
        (tmp_path / "arm.xml").write_text(init_models.arm_without_hand())
        result = robocell_command("init", tmp_path / "arm.xml", "-o", tmp_path / "out.yaml")
        assert "no run file: it picks, and the robot has no gripper. Comments in" in result.stdout
        assert not (tmp_path / "out_pick.yaml").exists()
        (tmp_path / "HAND.xml").write_text(
            init_models.model("hand", init_models.two_fingers(), init_models.finger_drive())
        )
        lines = (tmp_path / "out.yaml").read_text().splitlines()
        begin = lines.index("# attachments:")
        mount = [line.removeprefix("# ") for line in lines[begin : begin + 2]]
        (tmp_path / "out.yaml").write_text("\n".join([*lines, *mount]))
        config = robocell.RobotConfig.load(tmp_path / "out.yaml")
        scene = robocell.Scene.build(_alone(config))
        assert any(str(name).endswith("hand_left_finger") for name in scene.joint_names()), mount

    def test_an_arm_rooted_at_the_world_gets_a_base(self, tmp_path: Path):
        written = init(tmp_path, init_models.first_joint_at_the_root())
        assert written["root_body"] == "robot_base"
        assert written["move_groups"]["arm"]["joints"] == "j1..j6"

    def test_a_mocap_root_hangs_on_the_base_of_the_robot(self, tmp_path: Path):
        text = init_models.arm_without_hand().replace(
            "<body name='base'", "<body name='base' mocap='true'"
        )
        init(tmp_path, text)
        scene = robocell.Scene.build(_alone(robocell.RobotConfig.load(tmp_path / "out.yaml")))
        assert any("root 'base' is a mocap body" in note for note in scene.notes)
        robot = robocell.Robot.of(scene, "out")
        robot.base.pose = robocell.Pose(translation=[0.5, -0.25, 0], rpy=[0, 0, 1])
        scene.forward()
        assert robot.base_in_world.translation[:2] == pytest.approx([0.5, -0.25])

    def test_parts_that_move_below_the_base_clear_its_box(self, tmp_path: Path):
        below = "<geom type='box' size='.05 .05 .05' pos='0 0 -.24' contype='1' conaffinity='1'/>"
        text = init_models.arm_without_hand().replace("<body name='l3'", below + "<body name='l3'")
        text = text.replace("name='j2' axis='0 1 0'", "name='j2' axis='0 0 1'")
        written = init(tmp_path, text)
        assert written["base"]["size"][2] == 0.3
        (edit,) = [edit for edit in written["edits"] if edit.get("body") == "base"]
        assert 0.02 < edit["pos"][2] < 0.05  # 20 mm of the part are below the base
        checked = robocell_command("check", tmp_path / "out.yaml")
        assert "touch" not in checked.stdout + checked.stderr

    def test_servos_too_soft_for_their_joints_get_the_edits_that_check_names(self, tmp_path: Path):
        drive = "name='m_j6' joint='j6' kp='200.0' kv='20.0'"
        soft = drive.replace("kp='200.0' kv='20.0'", "kp='5' kv='12'")
        text = init_models.arm_without_hand()
        assert drive in text
        written = init(tmp_path, text.replace(drive, soft))
        assert [edit for edit in written["edits"] if edit.get("actuator") == "m_j6"]
        checked = robocell_command("check", tmp_path / "out.yaml")
        assert "no problems found" in checked.stdout

    @pytest.mark.parametrize("text", [init_models.without_servos(), init_models.urdf()])
    def test_joints_without_actuators_get_servos_that_hold_them(self, tmp_path: Path, text: str):
        name = "arm.urdf" if "<robot" in text else "arm.xml"
        written = init(tmp_path, text, name=name)
        assert written["model"] == ("arm.urdf" if "<robot" in text else "out_model.xml")
        config = robocell.RobotConfig.load(tmp_path / "out.yaml")
        scene = robocell.Scene.build(_alone(config))
        findings = robocell.diagnose.check_robot(robocell.Robot.of(scene, "out"))
        assert [str(f) for f in findings if f.severity is robocell.diagnose.Severity.WARNING] == []

    def test_a_urdf_keeps_its_fixed_links(self, tmp_path: Path):
        written = init(tmp_path, init_models.urdf(), name="arm.urdf")
        assert written["root_body"] == "base_link"
        assert written["move_groups"]["arm"]["leaf"] == {"body": "tool0"}

    @pytest.mark.parametrize(
        ("text", "joints"),
        [
            (init_models.parallelogram(), ["j1", "j2", "j4", "j5", "j6"]),
            (robot_models.delta(), ["lift", "turn", "shoulder", "roll"]),
        ],
    )
    def test_an_arm_whose_joints_follow_others_is_an_arm(
        self, tmp_path: Path, text: str, joints: list[str]
    ):
        written = init(tmp_path, text)
        assert written["move_groups"]["arm"]["kind"] == "arm"
        assert written["move_groups"]["arm"]["joints"] == joints
        assert "follows" in (tmp_path / "out.yaml").read_text()
        checked = robocell_command("check", tmp_path / "out.yaml")
        assert "no problems found" in checked.stdout

    def test_an_arm_that_robocell_cannot_use_becomes_a_generic_group(self, tmp_path: Path):
        # Each joint follows the other in turn: nothing leads.
        circle = init_models.parallelogram().replace(
            "</equality>",
            "<joint joint1='j2' joint2='j3' polycoef='0 -1 0 0 0'/></equality>",
        )
        (tmp_path / "arm.xml").write_text(circle)
        result = robocell_command("init", tmp_path / "arm.xml", "-o", tmp_path / "out.yaml")
        assert "'arm' cannot be commanded as an arm" in result.stderr
        written = yaml.safe_load((tmp_path / "out.yaml").read_text())
        assert kinds(written) == {"arm": "generic"}


def _alone(config: robocell.RobotConfig) -> robocell.SceneSpec:
    spec = robocell.SceneSpec(name="one", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots.append(robocell.RobotSpec(name="out", config=config))
    return spec


class TestFile:
    def test_every_guess_has_its_reason_above_it(self, tmp_path: Path):
        init(tmp_path, init_models.arm_with_hand())
        lines = (tmp_path / "out.yaml").read_text().splitlines()
        for start in ("root_body:", "base:", "  - {add_site", "  arm:", "  gripper:", "home:"):
            (at,) = [i for i, line in enumerate(lines) if line.startswith(start)]
            assert lines[at - 1].lstrip().startswith("# "), lines[at]
        assert any("[sure]" in line for line in lines)
        assert all(len(line) <= 100 for line in lines if line.lstrip().startswith("#"))

    def test_a_keyframe_named_home_is_used(self, tmp_path: Path):
        key = "<keyframe><key name='home' qpos='.1 .3 .9 0 .6 0 .03 .03'/></keyframe>"
        text = init_models.arm_with_hand().replace("</mujoco>", f"{key}</mujoco>")
        assert init(tmp_path, text)["home"]["arm"] == [0.1, 0.3, 0.9, 0, 0.6, 0]
        assert "the model's keyframe 'home' [sure]" in (tmp_path / "out.yaml").read_text()

    def test_a_keyframe_in_which_the_robot_touches_itself_is_not(self, tmp_path: Path):
        collide = init_models.arm_with_hand().replace("contype='0' conaffinity='0'", "", 1)
        key = "<keyframe><key name='home' qpos='0 0 2.6 0 2 0 .03 .03'/></keyframe>"
        init(tmp_path, collide.replace("</mujoco>", f"{key}</mujoco>"))
        text = " ".join((tmp_path / "out.yaml").read_text().replace("#", "").split())
        assert "not the keyframe 'home'" in text

    def test_ambiguous_yaml_names_are_quoted(self, tmp_path: Path):
        text = init_models.arm_with_hand().replace("'j1'", "'a: b'").replace("'m_j1'", "'#1'")
        written = init(tmp_path, text)
        assert written["move_groups"]["arm"]["joints"][0] == "a: b"

    def test_the_generated_run_file_produces_picks(self, tmp_path: Path):
        init(tmp_path, init_models.arm_with_hand())
        run = yaml.safe_load((tmp_path / "out_pick.yaml").read_text())
        assert run["robot"] == "out.yaml"
        result = robocell_command(
            "generate", tmp_path / "out_pick.yaml", "--episodes", 1, "--set", "cameras.streams=[]",
            "--output", tmp_path / "dataset",
        )  # fmt: skip
        assert result.returncode == 0, result.stdout + result.stderr


class TestCommand:
    def test_files_that_exist_are_kept_unless_forced(self, tmp_path: Path):
        init(tmp_path, init_models.scara())
        (tmp_path / "out.yaml").write_text("mine")
        message = refused("init", tmp_path / "arm.xml", "-o", tmp_path / "out.yaml")
        assert "exists. Replace it with --force" in message
        assert (tmp_path / "out.yaml").read_text() == "mine"
        init(tmp_path, init_models.scara(), "--force")
        assert (tmp_path / "out.yaml").read_text() != "mine"

    def test_leaves_no_other_files(self, tmp_path: Path):
        init(tmp_path, init_models.scara())
        assert sorted(file.name for file in tmp_path.iterdir()) == ["arm.xml", "out.yaml"]

    @pytest.mark.proof
    def test_takes_models_of_the_menagerie_by_their_names(self, tmp_path: Path):
        folder = tmp_path / "menagerie" / "acme_scara"
        folder.mkdir(parents=True)
        (folder / "acme_scara.xml").write_text(init_models.scara())
        root = {"MENAGERIE_ROOT": str(folder.parent)}
        out = tmp_path / "out.yaml"
        name = "menagerie:acme_scara/acme_scara.xml"
        for given in (name, "menagerie:acme_scara", folder / "acme_scara.xml"):
            made = robocell_command("init", given, "-o", out, "--force", environment=root)
            assert made.returncode == 0, made.stderr
            assert yaml.safe_load(out.read_text())["model"] == name
        for given, meant in (("acme_scara", name[:-4]), ("acme_scar/acme_scara.xml", name)):
            said = robocell_command("init", given, environment=root)
            assert said.returncode == 2
            assert f"Did you mean '{meant.removesuffix('/acme_scara')}'?" in said.stderr
        said = robocell_command("init", "menagerie:acme_scar", environment=root)
        assert (said.returncode, "Did you mean 'acme_scara'?" in said.stderr) == (2, True)

    def test_a_missing_model_error_lists_the_models_in_the_folder(self, tmp_path: Path):
        (tmp_path / "panda.xml").write_text(init_models.scara())
        assert "panda.xml" in refused("init", tmp_path / "pandas.xml")

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("<mujoco><worldbody/></mujoco>", "the model has no bodies"),
            (
                "<mujoco><worldbody><body><geom size='.1'/></body></worldbody></mujoco>",
                "has a hinge or a slide",
            ),
            ("<mujoco><worldbody><body", "MuJoCo cannot read it: XML parse error"),
            ("<mujocoinclude/>", "A model file begins with <mujoco> or <robot>"),
            ("name: x", "not an XML file"),
            (LFS_POINTER, "x.xml: a pointer of Git LFS, not the file itself: run `git lfs "),
            (
                "<mujoco><asset><mesh file='link.stl'/></asset><worldbody><body><joint/>"
                "<geom type='mesh' mesh='link'/></body></worldbody></mujoco>",
                "link.stl: a pointer of Git LFS, not the file itself: run `git lfs pull`",
            ),
        ],
    )
    def test_rejects_a_model_that_is_not_a_robot(self, tmp_path: Path, text: str, said: str):
        (tmp_path / "x.xml").write_text(text)
        (tmp_path / "link.stl").write_text(LFS_POINTER)
        assert said in refused("init", tmp_path / "x.xml", "-o", tmp_path / "x.yaml")
        assert not (tmp_path / "x.yaml").exists()

    def test_asks_about_ambiguous_choices(self, tmp_path: Path):
        (tmp_path / "arm.xml").write_text(
            init_models.scara().replace(
                "<site name='tool'", "<site name='north'/><site name='south' pos='0 0 .01'/><site"
            )
        )
        result = robocell_command(
            "init", tmp_path / "arm.xml", "-o", tmp_path / "out.yaml", "--interactive", input="2\n"
        )
        assert result.returncode == 0, result.stdout + result.stderr
        assert "TCP of arm?" in result.stdout
        leaf = yaml.safe_load((tmp_path / "out.yaml").read_text())["move_groups"]["arm"]["leaf"]
        assert leaf["site"] in ("north", "south")

    def test_draws_the_robot(self, tmp_path: Path):
        init(tmp_path, init_models.scara(), "--picture", tmp_path / "arm.png")
        assert (tmp_path / "arm.png").read_bytes().startswith(b"\x89PNG")
