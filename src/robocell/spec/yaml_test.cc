// Tests the reader's messages about invalid files: the place, the problem, the probable intention.
#include "robocell/spec/yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using ::testing::StartsWith;

std::string RobotError(const std::string& more) {
  return ParseError<RobotConfig>("name: arm\nmodel: arm.xml\n" + more);
}

std::string ObjectError(const std::string& more) {
  return ParseError<SceneObject>("name: cube\nmjcf_path: cube.xml\n" + more);
}

TEST(Yaml, ReportsAMisspelledFieldWithPlaceAndSuggestion) {
  EXPECT_EQ(ParseError<CameraSpec>("name: top\npos: [0, 0, 2]\nfvoy: 45\n"),
            "f.yaml is not valid: f.yaml:3:1: fvoy: a CameraSpec: no field 'fvoy'. Its fields: "
            "name, mjcf_path, pos, fovy, "
            "euler, quat, look_at, attach_to, quat_wxyz. Did you mean 'fovy'?");
}

TEST(Yaml, ReportsAllProblemsTogether) {
  const std::string error = RobotError(
      "root_bdy: link\n"
      "base: {kind: mocap, size: [0.25, 0.25]}\n"
      "move_groups:\n"
      "  arm: {kind: amr, joints: [a, b]}\n"
      "home: {arm: [0, .nan], grippr: [0]}\n"
      "reach: -1\n");
  EXPECT_THAT(error, HasSubstr("f.yaml is not valid, 6 problems:"));
  EXPECT_THAT(error, HasSubstr("f.yaml:3:1: root_bdy: "));
  EXPECT_THAT(error, HasSubstr("Did you mean 'root_body'?"));
  EXPECT_THAT(error, HasSubstr("f.yaml:4:27: base.size: expected a list of 3 numbers, found a list "
                               "of 2. Length, width and height of a box under the robot, metres."));
  EXPECT_THAT(error, HasSubstr("f.yaml:6:15: move_groups.arm.kind: 'amr' is not one of arm, "
                               "gripper, base, generic. Did you mean 'arm'?"));
  EXPECT_THAT(error, HasSubstr("f.yaml:7:17: home.arm[1]: nan is not a finite number"));
  EXPECT_THAT(error, HasSubstr("f.yaml:7:32: home.grippr: no move group 'grippr'"));
  EXPECT_THAT(error, HasSubstr("f.yaml:8:8: reach: -1 must be greater than 0"));
}

TEST(Yaml, ReportsAnUnreadableValueOnce) {
  const std::string error = ParseError<CameraSpec>("name: top\npos: here\nfovy: 45\n");
  EXPECT_EQ(error,
            "f.yaml is not valid: f.yaml:2:6: pos: expected a list of 3 numbers, found 'here'. "
            "Position in the parent, metres; required without a model.");
}

TEST(Yaml, AProblemHidesNoOther) {
  // "home" is not a parent of "home_noise".
  const std::string error =
      RobotError("move_groups: {arm: {joints: [a]}}\nhome: 3\nhome_noise: {arm: [-1]}\n");
  EXPECT_THAT(error, HasSubstr("f.yaml:4:7: home: expected names with values, found '3'"));
  EXPECT_THAT(error, HasSubstr("f.yaml:5:20: home_noise.arm[0]: -1 must not be negative"));
}

TEST(Yaml, RejectsDuplicateKeys) {
  EXPECT_THAT(RobotError("reach: 1\nreach: 2\n"),
              HasSubstr("f.yaml:4:1: reach: 'reach' is given twice"));
  EXPECT_THAT(RobotError("move_groups: {a: {}, a: {}}\n"),
              HasSubstr("f.yaml:3:22: move_groups.a: 'a' is given twice"));
}

TEST(Yaml, WrongKindsReportExpectedAndFoundValues) {
  EXPECT_THAT(ObjectError("fixed: maybe\n"),
              HasSubstr("f.yaml:3:8: fixed: expected true or false, found 'maybe'"));
  EXPECT_THAT(ObjectError("fixed: [true]\n"),
              HasSubstr("fixed: expected true or false, found a list"));
  EXPECT_THAT(ObjectError("pos: 3\n"), HasSubstr("pos: expected a list of 3 numbers, found '3'"));
  EXPECT_THAT(ObjectError("pos: [0, 0, up]\n"),
              HasSubstr("f.yaml:3:13: pos[2]: expected a number, found 'up'"));
  EXPECT_THAT(ObjectError("pos: [0, 0, 1m]\n"), HasSubstr("expected a number, found '1m'"));
  EXPECT_THAT(ObjectError("pos: [0, 0, ]\n"), HasSubstr("found a list of 2"));
  EXPECT_THAT(ObjectError("attach_to: [a]\n"),
              HasSubstr("expected world, root, shared_base, or {site: name}, found a list"));
  EXPECT_THAT(RobotError("base: mocap\n"),
              HasSubstr("base: expected the fields of a BaseConfig, found 'mocap'"));
  EXPECT_THAT(RobotError("edits: {body: a}\n"),
              HasSubstr("edits: expected a list, found names with values"));
  EXPECT_THAT(RobotError("home: [0]\n"),
              HasSubstr("home: expected names with values, found a list"));
  EXPECT_THAT(RobotError("gravcomp: 1\n"), HasSubstr("expected true or false, found '1'"));
}

TEST(Yaml, RejectsFractionsForIntegers) {
  const auto width = [](const std::string& value) {
    return ParseError<CameraSystemConfig>("resolution: [" + value + ", 240]\n");
  };
  EXPECT_EQ(width("320"), "");
  EXPECT_THAT(width("320.5"), HasSubstr("resolution[0]: expected a whole number, found '320.5'"));
  EXPECT_THAT(width("1e2"), HasSubstr("expected a whole number, found '1e2'; write 100"));
  EXPECT_THAT(width("99999999999"),
              HasSubstr("a whole number of at most 2147483647, found '99999999999'"));
  EXPECT_THAT(width("-99999999999999999999"), HasSubstr("a whole number not below -2147483648"));
  EXPECT_THAT(width("+64"), HasSubstr("found '+64'; write 64"));
  EXPECT_THAT(width("99999999999999999999999"), HasSubstr("a whole number of at most 2147483647"));
}

TEST(Yaml, NumbersAreReadInAllUsualForms) {
  const auto x = [](const std::string& value) {
    const std::string text = "name: a\nmjcf_path: a.xml\npos: [" + value + ", 0, 0]\n";
    return ParseYaml<SceneObject>(text).pos.value()[0];
  };
  EXPECT_EQ(x("1"), 1);
  EXPECT_EQ(x("+1.5"), 1.5);
  EXPECT_EQ(x("-.5"), -.5);
  EXPECT_EQ(x("1e-3"), 1e-3);
  EXPECT_EQ(x("'2'"), 2);
  EXPECT_EQ(x("1/480"), 1.0 / 480);
  EXPECT_EQ(x("-500/33"), -500.0 / 33);
  for (const char* text :
       {"+-1", "0x10", "1_000", "1,5", "--1", "1e999", "''", "1/0", "/2", "1/", "1/2/3"}) {
    EXPECT_THAT(ObjectError("pos: [\"" + std::string(text) + "\", 0, 0]\n"),
                HasSubstr("pos[0]: expected a number, found "))
        << text;
  }
}

TEST(Yaml, RejectsNonFiniteNumbers) {
  for (const char* text : {".nan", "nan", ".inf", "-.inf", "inf"}) {
    EXPECT_THAT(ObjectError("pos: [0, " + std::string(text) + ", 0]\n"),
                AllOf(HasSubstr("f.yaml:3:10: pos[1]: "), HasSubstr("is not a finite number")));
  }
}

TEST(Yaml, NullUnsetsOptionalFieldsOnly) {
  EXPECT_FALSE(ParseYaml<RobotConfig>("name: a\nmodel: b\nreach:\n").reach.has_value());
  EXPECT_THAT(RobotError("arrival_tolerance: ~\n"),
              HasSubstr("arrival_tolerance: expected a number, found nothing"));
}

TEST(Yaml, QuatWxyzIsReorderedAndNormalised) {
  const auto spec = ParseYaml<SceneObject>(
      "name: a\nmjcf_path: a.xml\nquat_wxyz: [0.353553, 0.146447, -0.353553, -0.853553]\n");
  EXPECT_NEAR(spec.quat[3], 0.353553, 1e-5);
  EXPECT_NEAR(spec.quat[0], 0.146447, 1e-5);
  EXPECT_NEAR(spec.quat[2], -0.853553, 1e-5);
  EXPECT_THAT(ObjectError("quat_wxyz: [1, 0, 0, 0]\nquat: [0, 0, 0, 1]\n"),
              HasSubstr("both quat and quat_wxyz are given"));
  EXPECT_THAT(ObjectError("quat: [0, 0, 0, 1]\nquat_wxyz: [1, 0, 0, 0]\n"),
              HasSubstr("both quat and quat_wxyz are given"));
  EXPECT_THAT(ObjectError("quat_wxyz: [1, 1, 0, 0]\n"),
              HasSubstr("f.yaml:3:12: quat: [1, 0, 0, 1] has length 1.41421, a rotation needs 1"));
  EXPECT_THAT(
      ObjectError("quat_wxyz: [1, 0, 0]\n"),
      AllOf(HasSubstr("quat_wxyz: expected a list of 4 numbers"), Not(HasSubstr("length"))));
}

TEST(Yaml, AWrongQuaternionLengthErrorExplainsTheOrder) {
  EXPECT_THAT(
      ObjectError("quat: [0.5, 0, 0, 0]\n"),
      HasSubstr("quat: [0.5, 0, 0, 0] has length 0.5, a rotation needs 1 (order is x, y, z, "
                "w)"));
}

TEST(Yaml, NameRangesAreExpanded) {
  const auto robot = ParseYaml<RobotConfig>(
      "name: a\nmodel: b\nmove_groups: {arm: {joints: joint1..joint7, actuators: [a1..a3, x]}}\n");
  EXPECT_EQ(robot.move_groups.at("arm").joints.size(), 7u);
  EXPECT_EQ(robot.move_groups.at("arm").actuators, (NameList{"a1", "a2", "a3", "x"}));
  EXPECT_THAT(RobotError("move_groups: {arm: {joints: joint7..joint1}}\n"),
              HasSubstr("f.yaml:3:29: move_groups.arm.joints: 'joint7..joint1' is not a range"));
  EXPECT_THAT(RobotError("move_groups: {arm: {joints: [a, b, a]}}\n"),
              HasSubstr("move_groups.arm.joints: 'a' is listed twice"));
}

TEST(Yaml, AttachTargetsAreReadInBothForms) {
  const auto target = [](const std::string& text) {
    return ParseYaml<SceneObject>("name: a\nmjcf_path: b\nattach_to: " + text + "\n").attach_to;
  };
  EXPECT_EQ(target("world"), World());
  EXPECT_EQ(target("shared_base"), SharedBase());
  EXPECT_EQ(target("{site: pinch}"), Site("pinch"));
  EXPECT_EQ(target("{robot_base: left}"), RobotBase("left"));
  EXPECT_THAT(ObjectError("attach_to: site\n"),
              HasSubstr("f.yaml:3:12: attach_to: which site? Its name is missing; write {site: "
                        "name}"));
  EXPECT_THAT(ObjectError("attach_to: {world: table}\n"),
              HasSubstr("'world' is a separate frame and takes no name; 'table'"));
  EXPECT_THAT(ObjectError("attach_to: {sitee: a}\n"),
              HasSubstr("f.yaml:3:13: attach_to: 'sitee' is not one of world, root, shared_base, "
                        "body, site, frame, robot_base, attachment. Did you mean 'site'?"));
  EXPECT_THAT(ObjectError("attach_to: {site: a, body: b}\n"), HasSubstr("expected world, root"));
}

TEST(Yaml, ElementsAreReadInAllForms) {
  const auto leaf = [](const std::string& text) {
    return *ParseYaml<RobotConfig>("name: a\nmodel: b\nmove_groups: {g: {leaf: " + text + "}}\n")
                .move_groups.at("g")
                .leaf;
  };
  EXPECT_EQ(leaf("tcp"), (ElementRef{.name = "tcp"}));
  EXPECT_EQ(leaf("{site: tcp}"), (ElementRef{.kind = ElementKind::kSite, .name = "tcp"}));
  EXPECT_EQ(leaf("{geom: {body: f, index: 3}}"),
            (ElementRef{.kind = ElementKind::kGeom, .body = "f", .index = 3}));
  EXPECT_EQ(leaf("{body: f, index: 2}"), (ElementRef{.body = "f", .index = 2}));
  const auto error = [](const std::string& text) {
    return RobotError("move_groups: {g: {leaf: " + text + "}}\n");
  };
  EXPECT_THAT(error("{body: f, idnex: 3}"),
              HasSubstr("f.yaml:3:35: move_groups.g.leaf.idnex: an unnamed element: no field "
                        "'idnex'. Its fields: body, index. Did you mean 'index'?"));
  EXPECT_THAT(error("{geom: {body: f, index: -1}}"), HasSubstr("index -1 is negative"));
  EXPECT_THAT(error("{geom: {index: 1}}"), HasSubstr("names no element"));
  EXPECT_THAT(error("''"), HasSubstr("names no element"));
  EXPECT_THAT(error("{stie: tcp}"), HasSubstr("Did you mean 'site'?"));
  EXPECT_THAT(error("[a]"), HasSubstr("expected a name, {site: name} or"));
}

TEST(Yaml, PosesAreReadAndChecked) {
  const auto spec = ParseYaml<RobotConfig>(
      "name: a\nmodel: b\nattachment_site: s\ntcp_offset: {pos: [0, 0, 0.1], euler: [0, 0, 90]}\n");
  EXPECT_NEAR(spec.tcp_offset->rpy()[2], 1.5707963, 1e-6);
  EXPECT_THAT(RobotError("attachment_site: s\ntcp_offset: {pos: [0, 0, 0.1], eulr: [0, 0, 90]}\n"),
              HasSubstr("f.yaml:4:32: tcp_offset.eulr: a Pose: no field 'eulr'"));
  EXPECT_THAT(RobotError("attachment_site: s\ntcp_offset: {quat: [0, 0, 0, 2]}\n"),
              HasSubstr("f.yaml:4:20: tcp_offset.quat: [0, 0, 0, 2] has length 2"));
  EXPECT_THAT(RobotError("attachment_site: s\ntcp_offset: {pos: [0, 0, .inf]}\n"),
              HasSubstr("tcp_offset.pos[2]: inf is not a finite number"));
}

TEST(Yaml, RejectsAnEmptyOrWrongDocument) {
  EXPECT_EQ(ParseError<RobotConfig>(""),
            "f.yaml is not valid: f.yaml: expected the fields of a RobotConfig, for example `name: "
            "...`, found nothing");
  EXPECT_THAT(ParseError<RobotConfig>("- a\n"), HasSubstr("f.yaml:1:1: expected the fields"));
  EXPECT_THAT(ParseError<RobotConfig>("hello\n"), HasSubstr("found 'hello'"));
}

TEST(Yaml, ReportsTheLineOfInvalidYaml) {
  EXPECT_THAT(ParseError<RobotConfig>("name: a\nmodel: [b\n"), HasSubstr("not valid YAML: "));
  EXPECT_THAT(ParseError<RobotConfig>("name: a\n\tmodel: b\n"), HasSubstr("f.yaml:2:1: not valid"));
}

TEST(Yaml, RejectsASecondDocument) {
  EXPECT_THAT(ParseError<RobotConfig>("name: a\nmodel: b\n---\nnmae: c\n"),
              HasSubstr("f.yaml:3:1: a second document starts here; a spec file has one"));
}

TEST(Yaml, UnreadableFilesAreIoErrors) {
  ExpectThrow<IoError>([] { RobotConfig::Load("/nonexistent/robot.yaml"); },
                       "/nonexistent/robot.yaml");
}

// A comparison with an unreadable list would be meaningless.
TEST(Yaml, AnUnreadableListIsOneProblem) {
  const std::string start = "name: a\nmodel: b\nmove_groups: {arm: {kind: arm, actuators: s1..s2, ";
  EXPECT_THAT(ParseError<RobotConfig>(start + "joints: [j1, [j2]]}}\nhome: {arm: [0, 1]}\n"),
              StartsWith("f.yaml is not valid: f.yaml:3:64: move_groups.arm.joints: expected a "
                         "name"));
  EXPECT_THAT(ParseError<RobotConfig>("name: a\nmodel: b\nmove_groups: {hand: {kind: gripper, "
                                      "actuators: g, fingers: [[l], r, s]}}\n"),
              StartsWith("f.yaml is not valid: f.yaml:3:61: move_groups.hand.fingers[0]: "));
}

}  // namespace
}  // namespace robocell
