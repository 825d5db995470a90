"""What `robocell init` reads off models, part by part, without the command."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

import hand_models
import init_models
import robot_models
from robocell import SpecError
from robocell._onboarding import Confidence, Guess, detect, model_text, pick_run, robot_text
from robocell._onboarding.actuation import Actuation, Drive
from robocell._onboarding.arm_control import drive_of
from robocell._onboarding.geometry import nearest_points
from robocell._onboarding.hands import _linkages, find_fingers
from robocell._onboarding.home import first_contact
from robocell._onboarding.jaws import is_jaw
from robocell._onboarding.limbs import Anatomy, LimbKind
from robocell._onboarding.mounted import find_mounts
from robocell._onboarding.pick_run import CANNOT_HOLD
from robocell._onboarding.robot_guess import Field, Group, RobotGuess
from robocell._onboarding.roots import anatomy_of, find_roots
from robocell._onboarding.source_model import SourceModel, load_model
from robocell._onboarding.trial import _edits_in
from robocell._onboarding.yaml_text import Raw, comment, flow, name_list


def source_of(folder: Path, text: str) -> SourceModel:
    file = folder / "model.xml"
    file.write_text(text)
    return load_model(file)


def anatomy(source: SourceModel) -> Anatomy:
    return anatomy_of(source, Actuation(source), source.children(0)[0])


class TestModels:
    def test_unnamed_elements_have_the_labels_of_robot_files(self, tmp_path: Path):
        world = (
            "<body><geom size='.1'/><joint/><site/><body><joint/><geom size='.1'/></body></body>"
        )
        drive = "<actuator><motor joint='hip'/><motor joint='hip'/></actuator>"
        named = world.replace("<joint/>", "<joint name='hip'/>", 1)
        source = source_of(tmp_path, init_models.model("x", named, drive))
        assert source.body_name(1) == "root_body"
        assert source.body_name(2) == "root_body:body0"
        assert source.joint_name(1) == "root_body:body0:joint0"
        assert source.site_name(0) == "root_body:site0"
        assert [source.actuator_name(i) for i in (0, 1)] == ["hip:actuator0", "hip:actuator1"]

    def test_an_unknown_package_of_a_urdf_mesh_is_named_with_its_line(self, tmp_path: Path):
        urdf = init_models.urdf().replace(
            '<cylinder radius=".06"\nlength=".12"/>', '<mesh filename="package://a/b.stl"/>'
        )
        file = tmp_path / "arm.urdf"
        file.write_text(urdf)
        with pytest.raises(
            SpecError, match=r"arm.urdf:2: link 'base_link': its mesh: no package 'a'"
        ):
            load_model(file)


class TestActuators:
    def test_kinds_are_those_of_their_force(self, tmp_path: Path):
        drives = (
            "<position joint='j1' kp='10'/><velocity joint='j2' kv='3'/><motor joint='j3'/>"
            "<intvelocity joint='j4' kp='5' actrange='-1 1'/><position joint='j5' kp='9' "
            "timeconst='.1'/><adhesion body='l6' ctrlrange='0 1'/>"
        )
        text = init_models.model("x", init_models.six_axis(), f"<actuator>{drives}</actuator>")
        found = [each.drive for each in Actuation(source_of(tmp_path, text)).actuators]
        assert found == [
            Drive.POSITION, Drive.VELOCITY, Drive.MOTOR, Drive.OTHER, Drive.POSITION,
            Drive.ADHESION,
        ]  # fmt: skip

    def test_a_tendon_drives_its_joints(self, tmp_path: Path):
        rest = (
            "<tendon><fixed name='t'><joint joint='j2' coef='1'/><joint joint='j5' coef='-2'/>"
            "</fixed></tendon><actuator><motor tendon='t'/></actuator>"
        )
        source = source_of(tmp_path, init_models.model("x", init_models.six_axis(), rest))
        (actuator,) = Actuation(source).actuators
        assert [source.joint_name(j) for j in actuator.joints] == ["j2", "j5"]
        assert not actuator.is_on_joint

    def test_equalities_carry_motion_along(self, tmp_path: Path):
        source = source_of(tmp_path, init_models.arm_with_hand())
        actuation = Actuation(source)
        (grip,) = [a for a in actuation.actuators if a.name == "grip"]
        names = {source.joint_name(joint) for joint in actuation.moved_by(grip)}
        assert names == {"left_finger", "right_finger"}


class TestParts:
    def test_objects_of_a_scene_are_not_robots(self, tmp_path: Path):
        source = source_of(tmp_path, init_models.two_arms_apart())
        roots = find_roots(source, Actuation(source))
        assert roots.value.names == ("left_base", "right_base")
        assert "left out of the model's world: table, cube" in roots.reason

    def test_a_wrist_that_folds_back_is_not_a_jaw(self, tmp_path: Path):
        text = init_models.model("x", init_models.six_axis())
        source = source_of(tmp_path, text)
        assert not any(is_jaw(source, joint) for joint in range(source.model.njnt))

    def test_a_jaw_is_recognised_in_any_arm_pose(self, tmp_path: Path):
        text = init_models.desktop_arm().replace(
            "<body name='shoulder' pos='0 0 .05'>",
            "<body name='shoulder' pos='0 0 .05' euler='.4 .9 -1.1'>",
        )
        source = source_of(tmp_path, text)
        assert is_jaw(source, int(source.model.joint("jaw").id))
        (limb,) = anatomy(source).limbs
        assert len(limb.joints) == 5

    @pytest.mark.parametrize("euler", ["0 0 0", "1.57 0 0", "0 3.14 0", ".3 -.8 2"])
    def test_fingers_are_found_in_any_hand_orientation(self, tmp_path: Path, euler: str):
        text = init_models.linkage_hand().replace(
            "<body name='hand'>", f"<body name='hand' euler='{euler}'>"
        )
        source = source_of(tmp_path, text)
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        fingers = find_fingers(source, Actuation(source), hand).fingers
        assert fingers is not None
        assert {source.body_name(body) for body in fingers.bodies} == {"left", "right"}
        assert (fingers.closed, fingers.open) == pytest.approx((0.002, 0.062), abs=1e-3)
        assert np.abs(fingers.closing) == pytest.approx([0, 1, 0], abs=0.02)

    def test_fingers_held_by_friction_are_found_with_reduced_friction(self, tmp_path: Path):
        held = init_models.arm_with_hand().replace("damping='5'", "damping='5' frictionloss='300'")
        source = source_of(tmp_path, held)
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        motion = find_fingers(source, Actuation(source), hand)
        assert motion.fingers is not None
        assert [source.joint_name(joint) for joint in motion.friction] == ["left_finger"]

    def test_home_is_collision_free_and_above_the_ground(self, tmp_path: Path):
        file = tmp_path / "arm.xml"
        file.write_text(init_models.arm_with_hand().replace("contype='0' conaffinity='0'", "", 1))
        guess = detect(file, tmp_path / "m.xml", "arm")
        source = guess.source
        qpos = source.model.qpos0.copy()
        qpos[:6] = guess.home["arm"]
        assert first_contact(source, source.subtree(1), qpos) is None
        data = source.new_data(qpos)
        hand = int(source.model.body("hand").id)
        assert data.xmat[hand].reshape(3, 3)[2, 2] < -0.9  # its z, where the fingers point, is down
        assert data.xpos[hand][0] > 0.2
        assert data.xpos[hand][2] > 0.1


class TestCoupledArms:
    def test_the_arm_has_a_joint_for_each_degree_of_freedom(self, tmp_path: Path):
        source = source_of(tmp_path, robot_models.delta())
        (limb,) = anatomy(source).arms
        drive = drive_of(source, Actuation(source), limb.joints)
        names = [source.joint_name(joint) for joint in drive.joints]
        assert names == ["lift", "turn", "shoulder", "roll"]
        assert drive.actuators == []  # robocell finds them
        assert "'elbow' follows 'shoulder', 'level' follows 'shoulder'" in drive.coupled

    def test_followers_settle_where_the_engine_puts_them(self, tmp_path: Path):
        source = source_of(tmp_path, robot_models.delta())
        qpos = source.model.qpos0.copy()
        qpos[source.model.joint("shoulder").qposadr[0]] = -0.7
        settled = Actuation(source).settled(qpos)
        data = mujoco.MjData(source.model)
        data.qpos[:] = settled
        mujoco.mj_forward(source.model, data)
        equalities = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        assert equalities.sum() >= 2
        assert np.abs(data.efc_pos[equalities]).max() < 1e-9

    def test_home_keeps_the_couplings_and_the_limits_of_followers(self, tmp_path: Path):
        file = tmp_path / "arm.xml"
        file.write_text(robot_models.delta())
        guess = detect(file, tmp_path / "m.xml", "arm")
        (arm,) = guess.of_kind("arm")
        assert "actuators" not in arm.fields
        shoulder = guess.home["arm"][2]
        for slope, name in ((-2, "elbow"), (1, "level")):
            lower, upper = guess.source.limits(int(guess.source.model.joint(name).id)) or (0, 0)
            assert lower <= slope * shoulder <= upper, name

    def test_a_loop_that_moves_a_joint_is_named_with_the_next_step(self, tmp_path: Path):
        text = robot_models.parallel_links()
        source = source_of(tmp_path, text)
        (limb,) = anatomy(source).arms
        why = drive_of(source, Actuation(source), limb.joints).why_not
        assert why.startswith("no actuator moves elbow. elbow is part of the loop that equality ")
        assert "'close' closes" in why
        assert '<joint joint1="elbow" joint2="LEADER"/>' in why
        level = text.replace("<connect name='close' body1='rod' body2='fore' anchor='0 0 .4'/>", "")
        level = level.replace(
            "<equality>",
            "<tendon><fixed name='sum'><joint joint='shoulder' coef='1'/><joint joint='elbow' "
            "coef='1'/></fixed></tendon><equality><tendon name='hold' tendon1='sum'/>",
        )
        source = source_of(tmp_path, level)
        elbow = int(source.model.joint("elbow").id)
        assert Actuation(source).loop_of(elbow) == (
            "one of the joints that equality 'hold' of sum ties"
        )


class TestMountedParts:
    """A hand on a free joint of its own that a weld holds on the arm, as tool changers do."""

    WELD = "<weld name='lock' body1='l6' body2='hand'/>"

    def changer(self, *, weld: str = WELD, hand_first: bool = False) -> str:
        hand = init_models.two_fingers().replace("pos='0 0 .06'>", "pos='.1 0 1.2'><freejoint/>", 1)
        spare = "<body name='spare' pos='1 0 0'><freejoint/><geom size='.03' mass='.2'/></body>"
        parts = [init_models.six_axis(), hand, spare]
        world = "".join(reversed(parts) if hand_first else parts)
        rest = init_models.finger_drive().replace("</equality>", f"{weld}</equality>")
        drives = f"<actuator>{init_models.servos(init_models.SIX_GAINS)}</actuator>"
        return init_models.model("changer", world, rest + drives)

    @pytest.mark.parametrize("hand_first", [False, True])
    @pytest.mark.parametrize(
        "weld",
        [
            WELD,
            "<weld body1='hand' body2='l6' relpose='0 0 -.06 .8 0 0 .6'/>",
            "<weld body1='l6' body2='hand' anchor='.1 .02 .03'/>",
            "<weld body1='hand' body2='l6' anchor='.1 .02 .03' relpose='.1 0 .2 .8 0 0 .6'/>",
        ],
    )
    def test_a_welded_tool_hangs_on_the_arm(self, tmp_path: Path, weld: str, hand_first: bool):
        file = tmp_path / "arm.xml"
        file.write_text(self.changer(weld=weld, hand_first=hand_first))
        guess = detect(file, tmp_path / "m.xml", "arm")
        assert [group.kind for group in guess.groups] == ["arm", "gripper"]
        assert any("a weld holds 'hand' on 'l6'" in reason for reason in guess.prepared)
        # The engine's own weld says where the hand is: it is satisfied in every pose of the arm.
        stock, made = mujoco.MjModel.from_xml_path(str(file)), guess.source.model
        assert (made.nq, made.nu) == (stock.nq - 7, stock.nu)
        rng = np.random.default_rng(0)
        for _ in range(5):
            ours, theirs = mujoco.MjData(made), mujoco.MjData(stock)
            for name in init_models.SIX_GAINS:
                value = rng.uniform(*made.joint(name).range)
                ours.joint(name).qpos = theirs.joint(name).qpos = value
            for name in ("right_finger", "left_finger"):
                ours.joint(name).qpos = theirs.joint(name).qpos = 0.01
            mujoco.mj_kinematics(made, ours)
            free = int(stock.body("hand").jntadr[0])
            at = int(stock.jnt_qposadr[free])
            theirs.qpos[at : at + 3] = ours.body("hand").xpos
            theirs.qpos[at + 3 : at + 7] = ours.body("hand").xquat
            mujoco.mj_forward(stock, theirs)
            equalities = theirs.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
            assert equalities.sum() >= 7
            assert np.abs(theirs.efc_pos[equalities]).max() < 1e-6
        again = tmp_path / "m.xml"
        again.write_text(model_text(guess.source, guess.prepared, guess.original))
        assert load_model(again).model.nq == made.nq

    def test_a_welded_tool_keeps_its_own_defaults(self, tmp_path: Path):
        text = self.changer().replace(
            "<worldbody>",
            "<default><default class='heavy'>"
            "<joint frictionloss='.7'/><geom contype='2'/></default></default><worldbody>",
            1,
        )
        text = text.replace("<body name='base'", "<body name='base' childclass='heavy'", 1)
        file = tmp_path / "arm.xml"
        file.write_text(text)
        stock = mujoco.MjModel.from_xml_path(str(file))
        made = detect(file, tmp_path / "m.xml", "arm").source.model
        for name in ("j6", "left_finger"):
            assert made.joint(name).frictionloss == stock.joint(name).frictionloss
        for name in ("l6", "hand", "left_finger"):
            ours, theirs = (
                model.geom_contype[model.geom_bodyid == model.body(name).id].tolist()
                for model in (made, stock)
            )
            assert ours == theirs, name

    def test_welded_bodies_without_a_robot_are_an_error_of_the_file(self, tmp_path: Path):
        body = "<body name='{0}'><freejoint/><geom size='.1'/></body>"
        welds = "<weld body1='a' body2='b'/><weld body1='b' body2='a'/>"
        file = tmp_path / "two.xml"
        file.write_text(
            f"<mujoco><worldbody>{body.format('a')}{body.format('b')}</worldbody>"
            f"<equality>{welds}</equality></mujoco>"
        )
        with pytest.raises(
            SpecError, match=r"two\.xml: no body of the model has a hinge or a slide"
        ):
            detect(file, tmp_path / "m.xml", "arm")

    def test_what_no_active_weld_holds_is_left_out(self, tmp_path: Path):
        file = tmp_path / "arm.xml"
        file.write_text(self.changer(weld="<weld body1='l6' body2='hand' active='false'/>"))
        source = load_model(file)
        assert find_mounts(source) == []
        guess = detect(file, tmp_path / "m.xml", "arm")
        (note,) = [note for note in guess.notes if "is off in the model" in note]
        assert note.startswith("weld '#1' of 'l6'")
        advised = note[note.index("<adhesion") : note.index("/>") + 2]
        file.write_text(file.read_text().replace("<actuator>", f"<actuator>{advised}", 1))
        again = detect(file, tmp_path / "m.xml", "arm")
        assert [group.kind for group in again.groups] == ["arm", "gripper"]
        file.write_text(self.changer())
        (mount,) = find_mounts(load_model(file))
        assert source.body_name(mount.part) == "hand"


class TestHands:
    def test_branches_that_connect_ties_are_one_finger(self, tmp_path: Path):
        def branch(name: str, y: float) -> str:
            return (
                f"<body name='{name}' pos='0 {y} 0'><joint name='{name}' axis='1 0 0'/>"
                "<geom size='.01'/></body>"
            )

        names = {"left": 0.03, "left_link": 0.02, "right_link": -0.02, "right": -0.03}
        ties = "".join(
            f"<connect body1='{side}' body2='{side}_link' anchor='0 0 .02'/>"
            for side in ("left", "right")
        )
        across = "<connect body1='left' body2='right' anchor='0 0 .02'/>"
        world = "".join(branch(name, y) for name, y in names.items())
        for rest, expected in ((ties, 2), (ties + across, 2), ("", 4)):
            text = init_models.model(
                "hand", f"<body name='hand'>{world}</body>", f"<equality>{rest}</equality>"
            )
            source = source_of(tmp_path, text)
            hand = source.children(0)[0]
            found = _linkages(source, [source.subtree(each) for each in source.children(hand)])
            groups = [sorted(source.body_name(body) for body in group) for group in found]
            assert len(groups) == expected
            if rest:
                assert groups == [["left", "left_link"], ["right", "right_link"]]

    def test_wheels_beside_each_other_are_no_hand(self, tmp_path: Path):
        wheels = "".join(
            f"<body pos='0 {y} .05'><joint name='{name}' axis='0 1 0'/>"
            "<geom type='cylinder' size='.05 .02'/></body>"
            for name, y in (("left", 0.15), ("right", -0.15))
        )
        text = init_models.model("cart", f"<body name='cart'><geom size='.1'/>{wheels}</body>")
        found = anatomy(source_of(tmp_path, text))
        assert [(limb.kind, limb.hand) for limb in found.limbs] == [(LimbKind.WHEEL, None)] * 2

    def test_groups_of_several_hands_have_names_of_their_own(self, tmp_path: Path):
        loose = init_models.two_fingers("b_").replace("axis='0 -1 0'", "axis='0 0 1'")
        world = init_models.six_axis(init_models.two_fingers())
        world = world.replace("<site name='flange'", f"{loose}<site name='flange'")
        drives = init_models.finger_drive() + init_models.finger_drive("b_")
        rest = drives + f"<actuator>{init_models.servos(init_models.SIX_GAINS)}</actuator>"
        guess = RobotGuess("a", None, Path("a"), [], Field("base"), Field({}))
        for name in ("hand", "hand", "hand"):
            guess.groups.append(Group(guess.free_name(name), {}, "", "generic"))
        assert [group.name for group in guess.groups] == ["hand", "hand2", "hand3"]
        file = tmp_path / "arm.xml"
        file.write_text(init_models.model("hands", world, rest))
        names = [group.name for group in detect(file, tmp_path / "m.xml", "arm").groups]
        assert len(names) == len(set(names)) >= 2

    def test_the_nearest_points_of_parallel_edges_are_their_middles(self):
        line = np.array([[x, 0.0, 0.0] for x in (-0.01, 0.0, 0.01)])
        gap, first, second = nearest_points(line, line + np.array([0, 0.02, 0]))
        assert gap == pytest.approx(0.02)
        assert first == pytest.approx([0, 0, 0])
        assert second == pytest.approx([0, 0.02, 0])

    def test_the_tips_of_a_jaw_are_in_the_middle_of_its_width(self, tmp_path: Path):
        source = source_of(tmp_path, init_models.desktop_arm())
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        fingers = find_fingers(source, Actuation(source), hand).fingers
        assert fingers is not None
        assert [tip[0] for tip in fingers.tips] == pytest.approx([0, 0], abs=1e-6)

    def test_the_first_of_three_fingers_closes_against_the_others(self, tmp_path: Path):
        source = source_of(tmp_path, robot_models.three_finger_arm())
        hand = anatomy(source).arms[0].hand
        assert hand is not None
        fingers = find_fingers(source, Actuation(source), hand).fingers
        assert fingers is not None
        first, *others = [*fingers.bodies, *(body for body, _ in fingers.others)]
        assert source.body_name(first) == "finger1"
        assert {source.body_name(body) for body in others} == {"finger2", "finger3"}
        assert np.abs(fingers.closing) == pytest.approx([1, 0, 0], abs=0.05)
        assert fingers.middle[1] == pytest.approx(0, abs=2e-3)

    @pytest.mark.parametrize(("fingers", "euler"), [(1, "0 0 0"), (2, ".4 .9 -1"), (3, "0 2 .3")])
    def test_fingers_with_many_joints_meet_in_their_poses(
        self, tmp_path: Path, fingers: int, euler: str
    ):
        text = hand_models.many_fingered_hand(fingers).replace(
            "<body name='palm'", f"<body name='palm' euler='{euler}'"
        )
        source = source_of(tmp_path, text)
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        motion = find_fingers(source, Actuation(source), hand)
        assert motion.poses, motion.why_none
        assert motion.fingers
        thumb, *others = [source.body_name(tip.body) for tip in motion.poses.tips]
        assert {thumb, *others} == {"th__3", *(f"f{index}__3" for index in range(fingers))}
        assert thumb == "th__3" or fingers == 1
        # Simulated with the servos, not as they were looked for.
        assert motion.fingers.closed < 0.002
        assert motion.fingers.open > 0.06
        assert set(motion.poses.poses) == (
            {"open", "closed", "pinch"} if fingers > 1 else {"open", "closed"}
        )

    def test_keyframes_of_a_hand_become_poses(self, tmp_path: Path):
        key = "<key name='Peace sign!' ctrl='" + " ".join(["0.1"] * 16) + "'/>"
        source = source_of(tmp_path, hand_models.many_fingered_hand(keys=key))
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        motion = find_fingers(source, Actuation(source), hand)
        assert motion.poses is not None
        assert motion.poses.keys == {"peace_sign": "Peace sign!"}
        assert set(motion.poses.poses["peace_sign"].values()) == {0.1}

    def test_a_hand_whose_fingers_do_not_meet_has_no_poses(self, tmp_path: Path):
        far = hand_models.many_fingered_hand().replace("pos='0 .04 0'", "pos='0 .4 0'")
        source = source_of(tmp_path, far)
        hand = anatomy(source).limbs[0].hand
        assert hand is not None
        motion = find_fingers(source, Actuation(source), hand)
        assert motion.fingers is None
        assert "do not meet" in motion.why_none


class TestPlaces:
    def test_a_base_below_the_floor_is_put_on_it(self, tmp_path: Path):
        file = tmp_path / "arm.xml"
        text = init_models.desktop_arm()
        for height, is_reset in (("0", False), ("-.1", True), (".1", False)):
            file.write_text(
                text.replace("<body name='base'", f"<body name='base' pos='0 0 {height}'")
            )
            assert detect(file, tmp_path / "m.xml", "arm").reset_root_pose == is_reset, height

    def test_arms_that_hang_sideways_keep_their_height(self, tmp_path: Path):
        text = init_models.two_arms_apart()
        for side, sign in (("left", ""), ("right", "-")):
            name = f"<body name='{side}_base' pos='"
            at = text.index(name) + len(name)
            end = text.index("'", at)
            text = f"{text[:at]}0 {sign}.1 .7' euler='{sign}1.5708 0 0{text[end:]}"
        file = tmp_path / "arm.xml"
        file.write_text(text)
        guess = detect(file, tmp_path / "m.xml", "arm")
        for side in ("left", "right"):
            assert guess.source.model.body(f"{side}_base").pos[2] == pytest.approx(0.7)
        assert "size" not in guess.base.value
        assert not [edit for edit in guess.edits if set(edit.value) == {"body", "pos"}]


class TestServos:
    @pytest.mark.parametrize("resists", ["damping='12'", "frictionloss='3'"])
    def test_added_servos_move_joints_that_resist(self, tmp_path: Path, resists: str):
        text = init_models.without_servos().replace("name='j6'", f"name='j6' {resists}")
        file = tmp_path / "arm.xml"
        file.write_text(text)
        model = detect(file, tmp_path / "m.xml", "arm").source.model
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        model.opt.gravity = 0
        data = mujoco.MjData(model)
        data.ctrl[:] = 0
        data.actuator("j6").ctrl = 0.1
        while data.time < 1:
            mujoco.mj_step(model, data)
        assert data.joint("j6").qpos[0] == pytest.approx(0.1, abs=0.012)

    def test_added_fingers_are_slow_enough_to_meet(self, tmp_path: Path):
        text = init_models.model("hand", init_models.six_axis(init_models.two_fingers()))
        file = tmp_path / "arm.xml"
        file.write_text(text)
        model = detect(file, tmp_path / "m.xml", "arm").source.model
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        data = mujoco.MjData(model)
        for side in ("left", "right"):
            data.joint(f"{side}_finger").qpos = 0.03
        fastest = 0.0
        while data.time < 1:
            mujoco.mj_step(model, data)
            fastest = max(fastest, float(np.abs(data.joint("left_finger").qvel[0])))
        assert fastest < 0.6
        assert data.joint("left_finger").qpos[0] < 0.002


class TestFindings:
    def test_edits_of_numbers_are_read_from_a_finding(self):
        text = (
            "joint 'a' takes 1.5 s (53 would do). Raise the stiffness of its servo "
            "(edits: [{actuator: 'm_a', kp: 53}, {joint: 'b', frictionloss: 1.5e-02}])"
        )
        assert _edits_in(text) == [
            "{actuator: 'm_a', kp: 53}",
            "{joint: 'b', frictionloss: 1.5e-02}",
        ]
        assert _edits_in("write edits: [{delete: {joint: 'a'}}]") == []

    def test_what_a_gripper_cannot_hold_is_read_from_a_finding(self):
        text = "gripper 'g' cannot hold 'mug' (it is 0.06 m wide): such starts are refused. Leave"
        assert re.findall(CANNOT_HOLD, text) == [("mug", "it is 0.06 m wide")]


class TestObjects:
    @pytest.mark.parametrize(
        ("found", "kinds", "why"),
        [
            ([{}], (), ""),
            ([None], (), ""),
            ([{"a": "wide"}], ("b",), ""),
            ([{"a": "wide", "b": "wide"}, {}], ("c", "d"), ""),
            ([{"a": "wide", "b": "wide"}, {"c": "low"}], ("d",), ""),
            ([{"a": "wide", "b": "wide"}, {"c": "low", "d": "low"}], (), "wide"),
            ([{"a": "wide", "b": "wide"}, None], (), "wide"),
        ],
    )
    def test_the_usual_kinds_go_before_the_others_of_the_catalogue(
        self,
        found: list[dict[str, str] | None],
        kinds: tuple[str, ...],
        why: str,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
    ):
        guess = RobotGuess("a", None, Path("a"), [], Field("base"), Field({}))
        monkeypatch.setattr(pick_run, "default_object_kinds", lambda: ["a", "b"])
        monkeypatch.setattr(pick_run, "object_kinds", lambda: ["a", "b", "c", "d"])
        monkeypatch.setattr(pick_run, "run_text", lambda *_: "")
        monkeypatch.setattr(pick_run, "_refused", lambda _: found.pop(0))
        held = pick_run.objects_held(guess, tmp_path / "a.yaml", tmp_path / "a_pick.yaml")
        assert (held.kinds, held.why_none) == (kinds, why)


class TestText:
    @pytest.mark.parametrize(
        "value",
        [
            {"kind": "arm", "joints": ["a: b", "#1", "it's", "on", "1.5", "left/j1", "x y", ""]},
            {"pos": [0.1, -2.0, 3], "ok": True, "nested": {"site": "tcp"}},
        ],
    )
    def test_written_values_round_trip_through_yaml(self, value: dict):
        assert yaml.safe_load(flow(value)) == value

    def test_numbered_names_are_a_range(self):
        assert name_list(["j1", "j2", "j3"]) == "j1..j3"
        assert isinstance(name_list(["j1", "j2", "j3"]), Raw)
        assert name_list(["j1", "j2", "j4"]) == ["j1", "j2", "j4"]

    def test_comments_are_as_wide_as_lines(self):
        lines = comment("word " * 60, "  ")
        assert len(lines) > 2
        assert all(line.startswith("  # ") and len(line) <= 100 for line in lines)

    def test_a_certain_guess_offers_no_alternatives(self):
        assert Guess("a", "why", Confidence.HIGH, ("b",)).comment() == "why [sure]"
        assert Guess("a", "why", Confidence.LOW, ("b",)).comment() == (
            "why [unsure, please check]; instead of it: b"
        )

    def test_a_rewritten_model_loads_and_explains_the_changes(self, tmp_path: Path):
        file = tmp_path / "arm.xml"
        file.write_text(init_models.two_arms_apart())
        guess = detect(file, tmp_path / "m.xml", "arm")
        (tmp_path / "m.xml").write_text(model_text(guess.source, guess.prepared, guess.original))
        again = load_model(tmp_path / "m.xml")
        assert again.model.nq == guess.source.model.nq
        np.testing.assert_allclose(again.model.body_pos, guess.source.model.body_pos, atol=1e-6)
        # The first arm is at the origin, and the second where it was beside it.
        left, right = (again.model.body(f"{side}_base").pos for side in ("left", "right"))
        np.testing.assert_allclose([left, right], [[0, 0, 0], [0, -0.8, 0]], atol=1e-6)
        assert "m.xml" in robot_text(guess, tmp_path / "arm.yaml")
