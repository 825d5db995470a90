// Tests the hints for a value of the wrong form, a misspelt field, and a file of another kind.
#include "robocell/spec/yaml_hints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/testing/messages.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;

std::string HintFor(const std::string& field) {
  return ParseError<RobotConfig>("name: arm\nmodel: arm.xml\n" + field + "\n");
}

TEST(Hints, AnAttachTargetWithoutItsKind) {
  EXPECT_EQ(HintFor("attachments: [{mjcf_path: a.xml, prefix: g_, attach_to: pinch_site}]"),
            "f.yaml is not valid: f.yaml:3:57: attachment 'g_' (attachments[0]).attach_to: "
            "expected world, root, "
            "shared_base, or {site: name}, found 'pinch_site'; write {site: pinch_site} if it is a "
            "site, or {body: pinch_site}, {frame: pinch_site}. Body, site or frame of the robot or "
            "of an earlier attachment, by its name without the robot's prefix.");
  EXPECT_THAT(HintFor("attachments: [{mjcf_path: a.xml, prefix: g_, attach_to: wrold}]"),
              HasSubstr("{frame: wrold}. Did you mean 'world'? Body, site"));
}

TEST(Hints, AValueInsteadOfFields) {
  EXPECT_THAT(HintFor("base: mocap"),
              HasSubstr("base: expected the fields of a BaseConfig, found 'mocap'; write {kind: "
                        "mocap}. Base that the robot stands on."));
  EXPECT_THAT(HintFor("base: [0.2, 0.2, 0.3]"),
              HasSubstr("found a list; write {size: [0.2, 0.2, 0.3]}"));
  EXPECT_THAT(HintFor("attachment_site: s\ntcp_offset: [0, 0, 0.1]"),
              HasSubstr("tcp_offset: expected the fields of a Pose, found a list; write {pos: [0, "
                        "0, 0.1]}"));
  EXPECT_THAT(HintFor("move_groups: {arm: arm}"), HasSubstr("; write {kind: arm}"));
  EXPECT_THAT(HintFor("move_groups: {arm: [j1, j2]}"), HasSubstr("; write {joints: [j1, j2]}"));
  EXPECT_THAT(
      HintFor("move_groups: {g: {kind: gripper, actuators: a, ctrl: [0, 255]}}"),
      HasSubstr("ctrl: expected the fields of a GripperCtrl, found a list; its fields: open, "
                "closed"));
}

TEST(Hints, NumbersInsteadOfAList) {
  EXPECT_THAT(HintFor("base: {size: 0.2 0.2 0.3}"),
              HasSubstr("base.size: expected a list of 3 numbers, found '0.2 0.2 0.3'; write [0.2, "
                        "0.2, 0.3]"));
  EXPECT_THAT(HintFor("base: {size: {x: 0.2, y: 0.2, z: 0.3}}"),
              HasSubstr("found names with values; write [0.2, 0.2, 0.3]"));
  EXPECT_THAT(HintFor("base: {size: 0.2}"), HasSubstr("found '0.2'. Length, width"));
}

TEST(Hints, ListsAndMappingsMixedUp) {
  EXPECT_THAT(HintFor("home: [0, 0]"),
              HasSubstr("home: expected names with values, found a list; write {arm: [0, 0]} with "
                        "the name of the group in the place of `arm`"));
  EXPECT_THAT(HintFor("home: ready"),
              HasSubstr("home: expected names with values, found 'ready'; write {arm: [0, 0.5]} "
                        "with the name of the group in the place of `arm`, and its numbers"));
  for (const char* control : {"control: [joint_position]", "control: joint_position"}) {
    EXPECT_THAT(
        HintFor(control),
        HasSubstr("; write {arm: joint_position} with the name of the group in the place of "
                  "`arm`"));
  }
  EXPECT_THAT(HintFor("control: [joint_position, velocity]"),
              HasSubstr("; write {arm: joint_position} with the name of each group"));
  EXPECT_THAT(HintFor("move_groups:\n  - {kind: arm, joints: [a]}"),
              HasSubstr("; write `name: {...}` for each, without dashes"));
  EXPECT_THAT(HintFor("edits: {body: link, pos: [0, 0, 0]}"),
              HasSubstr("edits: expected a list, found names with values; put brackets around it: "
                        "[{...}]"));
  EXPECT_THAT(HintFor("cameras:\n  name: wrist\n  pos: [0, 0, 0]"),
              HasSubstr("found names with values; begin each of its entries with a dash: `- `"));
  EXPECT_THAT(HintFor("move_groups:\n  - name: left\n    kind: arm"),
              HasSubstr("; write `left:` instead of `- name: left`, without the dash"));
}

TEST(Hints, ListsInQuotesOrWithoutBrackets) {
  EXPECT_THAT(HintFor("base: {size: '[0.1, 0.2, 0.3]'}"),
              HasSubstr("found '[0.1, 0.2, 0.3]'; write it without the quotes: [0.1, 0.2, 0.3]"));
  EXPECT_THAT(HintFor("home: {arm: \"[0, 0]\"}"),
              HasSubstr("found '[0, 0]'; write it without the quotes: [0, 0]"));
  EXPECT_THAT(HintFor("move_groups: {arm: {kind: arm, joints: '[a, b]'}}"),
              HasSubstr("joints: expected a name, or a list of names, found '[a, b]'; write it "
                        "without the quotes: [a, b]"));
  EXPECT_THAT(HintFor("move_groups:\n  arm:\n    joints: a, b"),
              HasSubstr("expected a name, or a list of names, found 'a, b'; write [a, b]"));
  EXPECT_EQ(HintFor("move_groups: {arm: {kind: arm, joints: 'a, b'}}"), "") << "a curious name";
  EXPECT_THAT(HintFor("home: {arm: 0 0.5 -1}"),
              HasSubstr("expected a number, found '0 0.5 -1'; write [0, 0.5, -1]"));
}

TEST(Hints, ValuesAfterACommaWithoutBrackets) {
  EXPECT_EQ(HintFor("move_groups: {arm: {kind: arm, joints: [a, b]}}\nhome: {arm: 0, 0, 1}"),
            "f.yaml is not valid: f.yaml:4:8: home.arm: it ends at the comma, and what follows has "
            "no name; if a list was meant, write arm: [0, 0, 1]");
  EXPECT_EQ(HintFor("base: {size: 0.1, 0.2, 0.3}"),
            "f.yaml is not valid: f.yaml:3:8: base.size: it ends at the comma, and what follows "
            "has no name; if a list was meant, write size: [0.1, 0.2, 0.3]");
}

TEST(Hints, FieldsWithoutAValueAreNotListItems) {
  for (const std::string nothing : {"null", "~", ""}) {
    EXPECT_EQ(HintFor("base: {kind: mocap, size: " + nothing + "}"), "") << nothing;
    EXPECT_EQ(HintFor("base: {kind: mocap, size: " + nothing + " }"), "") << nothing;
    EXPECT_EQ(HintFor("base: {kind: mocap, \"size\": " + nothing + "}"), "") << nothing;
    const std::string arm = "move_groups: {arm: {kind: arm, actuators: ";
    EXPECT_THAT(
        HintFor(arm + nothing + ", joints: [a]}}"),
        AllOf(HasSubstr("f.yaml:3:43: move_groups.arm.actuators: expected a name, a list of "),
              HasSubstr(", found nothing")))
        << nothing;
    EXPECT_THAT(HintFor("base: {kind: mocap, colour: " + nothing + "}"),
                HasSubstr("base.colour: a BaseConfig: no field 'colour'"))
        << nothing;
    EXPECT_THAT(HintFor("control: {arm: joint_position, hand: " + nothing + "}"),
                HasSubstr("control.hand: expected one of"))
        << nothing;
  }
  EXPECT_THAT(HintFor("move_groups: {arm: {kind: arm, joints: one, two }}"),
              HasSubstr("if a list was meant, write joints: [one, two]"));
}

TEST(Hints, FieldsThatAreNotIndented) {
  EXPECT_EQ(HintFor("move_groups:\n  arm:\n  kind: arm\n  joints: [a, b]"),
            "f.yaml is not valid: f.yaml:4:3: move_groups.arm: nothing belongs to it: `kind` of "
            "line 5 begins in the same column; what belongs to `arm` is indented further than it");
  EXPECT_EQ(HintFor("base:\nkind: mocap\nsize: [1, 1, 1]"),
            "f.yaml is not valid: f.yaml:3:1: base: nothing belongs to it: `kind` of line 4 begins "
            "in the same column; what belongs to `base` is indented further than it");
  EXPECT_THAT(HintFor("base:\ngravcmp: true"), HasSubstr("Did you mean 'gravcomp'?"));
}

TEST(Hints, AColonWithoutASpace) {
  EXPECT_THAT(HintFor("move_groups:\n  arm:\n    kind: arm\n    joints:[a, b]"),
              HasSubstr("f.yaml:6:5: move_groups.arm.joints:[a, b]: there is no blank after the "
                        "`:`; write `joints: [a, b]`"));
  EXPECT_THAT(HintFor("move_groups:\n  arm:\n    kind:arm"),
              HasSubstr("found 'kind:arm'; there is no blank after the `:`; write `kind: arm`"));
  EXPECT_THAT(
      HintFor("move_groups: {arm: {kind: arm, joints:[a, b]}}"),
      HasSubstr("f.yaml:3:39: not valid YAML: there is no blank between the `:` and the `[` "
                "of line 3, column 39"));
  EXPECT_THAT(HintFor("home:{arm: [0, 0]}"),
              HasSubstr("there is no blank between the `:` and the `{` of line 3, column 6"));
}

TEST(Hints, TabsThatIndent) {
  EXPECT_THAT(ParseError<RobotConfig>("name: arm\nbase:\n  \tkind: mocap\n"),
              HasSubstr("f.yaml:3:1: not valid YAML: the line is indented with a tab; use spaces"));
  EXPECT_THAT(ParseError<RobotConfig>("name:\tarm\nmodel: [b\n"), Not(HasSubstr("tab")));
}

TEST(Hints, AColonWithoutQuotes) {
  EXPECT_THAT(HintFor("root_body: menagerie: panda"),
              HasSubstr("a second `: ` in one line; a text that holds `: ` must be in quotes"));
}

TEST(Hints, AModelFile) {
  for (const char* text : {"<mujoco model=\"arm\">\n</mujoco>", "\n<?xml version=\"1.0\"?>",
                           "<!-- rc7: an arm -->\n<mujoco/>"}) {
    EXPECT_THAT(ParseError<RobotConfig>(text),
                HasSubstr("f.yaml: this is XML, a model file; a YAML file is wanted here"));
  }
}

TEST(Misspelt, ARequiredFieldIsOneProblem) {
  EXPECT_EQ(ParseError<RobotConfig>("name: arm\nmodle: arm.xml\n"),
            "f.yaml is not valid: f.yaml:2:1: modle: a RobotConfig: no field 'modle'. Its fields: "
            "name, model, edits, attachments, root_body, base, reset_root_pose, move_groups, "
            "attachment_site, tcp_offset, home, home_noise and 11 more. Did you mean 'model'?");
}

TEST(Misspelt, ConsequencesAreNotReported) {
  const std::string error = HintFor(
      "move_gruops: {arm: {kind: arm, joints: [a, b]}}\nhome: {arm: [0, 0]}\ncontrol: {arm: "
      "joint_position}");
  EXPECT_THAT(error, AllOf(HasSubstr("no field 'move_gruops'"), Not(HasSubstr("problems"))));
}

TEST(Misspelt, ButOtherProblemsAreReported) {
  const std::string error =
      HintFor("move_gruops: {arm: {kind: arm, joints: [a, b]}}\nhome: {arm: [0, 0, 0]}");
  EXPECT_THAT(error, AllOf(HasSubstr("2 problems"),
                           HasSubstr("home.arm: has 3 values for the 2 joints a, b")));
}

TEST(Misspelt, AValueThatDoesNotFitTheNearestFieldIsIgnored) {
  const std::string error = HintFor("bas: 3");
  EXPECT_THAT(error, AllOf(HasSubstr("Did you mean 'base'?"), Not(HasSubstr("expected"))));
}

TEST(Misspelt, AFieldThatIsAlsoGivenIsNotOverwritten) {
  EXPECT_THAT(HintFor("modle: other.xml"),
              AllOf(HasSubstr("Did you mean 'model'?"), Not(HasSubstr("problems"))));
}

constexpr const char* kShortRun = "run: r\nrobot: arm.yaml\ntask: {kind: pick}\noutput: out\n";
constexpr const char* kScene = "timestep: 0.002\nadd_floor: true\nrobots: []\nobjects: []\n";

TEST(Hints, TwoElementsInsteadOfOne) {
  EXPECT_THAT(
      HintFor("move_groups: {a: {kind: arm, joints: j1, leaf: {site: tip, body: hand}}}"),
      HasSubstr("move_groups.a.leaf: expected one element, as a name or {site: name}, found names "
                "with values; write one of them: {site: tip}"));
}

TEST(OtherKind, ARunFileInsteadOfARobotFile) {
  EXPECT_EQ(
      ParseError<RobotConfig>(kShortRun),
      "f.yaml is not valid: f.yaml:1:1: this looks like a run file: it has run, robot, task, "
      "output. A robot file is wanted here. Make its dataset with `robocell generate f.yaml`");
}

TEST(OtherKind, ARobotFileInsteadOfARunFile) {
  const std::string robot = "name: a\nmodel: a.xml\nroot_body: b\nmove_groups: {}\n";
  EXPECT_THAT(ParseError<RunConfig>(robot),
              AllOf(HasSubstr("looks like a robot file: it has name, model, root_body"),
                    EndsWith("Look at the robot with `robocell check f.yaml`")));
}

TEST(OtherKind, ASceneFile) {
  EXPECT_THAT(ParseError<RobotConfig>(kScene), HasSubstr("this looks like a scene file"));
  EXPECT_THAT(ParseError<CameraSpec>(kScene), HasSubstr("A CameraSpec file is wanted here"));
}

TEST(OtherKind, AFileWithFieldsOfSeveralKinds) {
  EXPECT_THAT(
      ParseError<RobotConfig>("robots: {a: r.yaml, b: r.yaml}\n"),
      HasSubstr("this looks like a scene file or an environment file: it has robots. A robot file "
                "is wanted here. Build it with Scene.build(SceneSpec.load(f.yaml)). Load it with "
                "EnvConfig.load(f.yaml)"));
}

TEST(Hints, AStringWithTheNameOfAField) {
  EXPECT_THAT(
      ParseError<RunConfig>("run: a\nexpert: {kind: mine}\n"),
      HasSubstr("f.yaml:2:9: expert: expected a text, found names with values; write `mine` "
                "alone. Source of the actions: a registered kind of expert"));
  EXPECT_THAT(ParseError<RunConfig>("expert: [mine]\n"),
              HasSubstr("found a list; write `mine` al"));
  EXPECT_THAT(ParseError<RunConfig>("expert: {kind: mine, gain: 2}\n"), Not(HasSubstr("alone")));
}

TEST(Hints, ATopLevelFieldInsideAValue) {
  EXPECT_THAT(
      HintFor("move_groups: {right: {kind: arm, joints: j1, control: joint_torque}}"),
      AllOf(HasSubstr("move_groups.right.control: a MoveGroupConfig: no field 'control'"),
            EndsWith(" `control` is a field of the whole file: write it at the top level, not "
                     "indented")));
  EXPECT_THAT(HintFor("contrl: {}"), Not(HasSubstr("top level")));
}

TEST(OtherKind, OneStrayFieldIsNotAnotherKind) {
  EXPECT_THAT(HintFor("task: {kind: pick}"), HasSubstr("no field 'task'"));
}

}  // namespace
}  // namespace robocell::internal
