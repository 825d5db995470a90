// Tests --set path.to.field=value: the same checks, and messages that name the option.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/render_quality.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

class OverrideTest : public ::testing::Test {
 protected:
  OverrideTest() {
    std::filesystem::create_directories(folder_);
    Write("arm.yaml", "name: arm\nmodel: arm.xml\nmove_groups: {arm: {joints: [a, b]}}\n");
    Write("run.yaml",
          "run: r\nrobot: arm.yaml\nstart: {base_distance: [0.2, 0.4]}\noutput: o\n"
          "cameras: {streams: [{name: wrist, camera: w}, {name: exo, camera: e}]}\n");
  }
  ~OverrideTest() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  RunConfig Load(const std::vector<std::string>& overrides) {
    return LoadYaml<RunConfig>(run(), overrides);
  }
  std::string Error(const std::vector<std::string>& overrides) {
    try {
      Load(overrides);
      return "";
    } catch (const SpecError& e) {
      return e.what();
    }
  }
  std::string run() const { return (folder_ / "run.yaml").string(); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("robocell_override_" + std::to_string(::getpid()) + "_" +
       ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(OverrideTest, MissingFieldsOfAnEmptyFileAreReportedInTheFile) {
  Write("run.yaml", "");
  const std::string error = Error({"output=elsewhere"});
  EXPECT_THAT(error, HasSubstr("run.yaml: run: is required"));
  EXPECT_THAT(error, ::testing::Not(HasSubstr("--set output")));
  // A missing field of a part that only the option made is a problem of the option.
  EXPECT_THAT(Error({"run=r", "cameras.streams=[{name: wrist}]"}),
              HasSubstr("--set cameras.streams"));
}

TEST_F(OverrideTest, ReplacesFieldsOfTheFile) {
  EXPECT_EQ(Load({"start.base_distance=[0.3, 0.5]"}).start.base_distance, (Vec2{0.3, 0.5}));
  EXPECT_EQ(Load({"start.base_distance[1]=0.6"}).start.base_distance, (Vec2{0.2, 0.6}));
  EXPECT_EQ(Load({"run=other"}).run, "other");
}

TEST_F(OverrideTest, FieldsOfAMapWithoutAValueAreNotListItems) {
  for (const std::string nothing : {"null", "~", ""}) {
    EXPECT_THAT(Error({"task={kind: pick, objects: " + nothing + "}"}),
                HasSubstr("task.objects: expected a name, a list of names, or a range like "
                          "joint1..joint7, found nothing"))
        << nothing;
  }
}

TEST_F(OverrideTest, AddsMissingFields) {
  EXPECT_EQ(Load({"episodes=5"}).episodes, 5);
  EXPECT_EQ(Load({"rates.policy_ms=40", "rates.control_ms=4"}).rates.policy_ms, 40);
  EXPECT_EQ(Load({"cameras.renderer.quality.shadows=true"}).cameras.renderer.quality.shadows, true);
  EXPECT_EQ(Load({"cameras.renderer.quality=high"}).cameras.renderer.quality, NamedQuality("high"));
  EXPECT_EQ(Load({"cameras.renderer.backend=gl"}).cameras.renderer.backend, "gl");
}

TEST_F(OverrideTest, AppliesToListElements) {
  const RunConfig run = Load({"cameras.streams[1].width=640"});
  EXPECT_EQ(run.cameras.streams[1].width, 640);
  EXPECT_EQ(run.cameras.streams[1].name, "exo");
  EXPECT_FALSE(run.cameras.streams[0].width.has_value());
}

TEST_F(OverrideTest, AppliesToTheRobotFile) {
  const RunConfig run = Load({"robot.home.arm=[1, 2]", "robot.base={kind: mocap}"});
  EXPECT_EQ(run.robot.config.home.at("arm"), (std::vector<double>{1, 2}));
  EXPECT_EQ(run.robot.config.base.kind, BaseKind::kMocap);
  EXPECT_EQ(run.robot.config.name, "arm");
}

TEST_F(OverrideTest, TheLastOverrideWins) { EXPECT_EQ(Load({"seed=1", "seed=2"}).seed, 2); }

TEST_F(OverrideTest, NullUnsets) {
  EXPECT_FALSE(Load({"episodes=5", "episodes=null"}).episodes.has_value());
}

TEST_F(OverrideTest, IsValidatedLikeTheFile) {
  EXPECT_EQ(
      Error({"task.lift_hight=0.1"}),
      run() +
          " is not valid: --set task.lift_hight=0.1: task.lift_hight: a PickTaskConfig: no field "
          "'lift_hight'. Its fields: kind, object, spread, rotate, refer, lift_height, arm, "
          "objects. Did you mean 'lift_height'?");
  EXPECT_THAT(Error({"task.base_distance=[0.3, 0.5]"}),
              HasSubstr("It is a field of `start` of a run, for all tasks: start.base_distance"));
  EXPECT_THAT(Error({"start.base_distance=[0.3, far]"}),
              HasSubstr("--set start.base_distance=[0.3, far]: start.base_distance[1]: expected a "
                        "number, found 'far'"));
  EXPECT_THAT(Error({"start.base_distance=[0.5, 0.3]"}),
              HasSubstr("--set start.base_distance=[0.5, 0.3]: start.base_distance: [0.5, 0.3] is "
                        "[smallest, largest]"));
  EXPECT_THAT(Error({"tsk.lift_height=0.1"}), HasSubstr("Did you mean 'task'?"));
  EXPECT_THAT(Error({"robot.hme.arm=[1, 2]"}), HasSubstr("Did you mean 'home'?"));
  EXPECT_THAT(Error({"robot.home.arm=[1]"}),
              HasSubstr("--set robot.home.arm=[1]: robot.home.arm: has 1 value for the 2 joints"));
  EXPECT_THAT(Error({"seed=99999999999999999999"}),
              HasSubstr("--set seed=99999999999999999999: seed: expected a whole number of at most "
                        "9223372036854775807"));
}

TEST_F(OverrideTest, RejectsAnInvalidPath) {
  EXPECT_THAT(Error({"cameras.streams[7].width=640"}),
              HasSubstr("--set cameras.streams[7].width=640: 'cameras.streams[7].width' leads to "
                        "nothing in"));
  EXPECT_THAT(Error({"run.name=x"}), HasSubstr("--set run.name=x: "));
  EXPECT_THAT(Error({"start.base_distance.x=1"}), HasSubstr("--set start.base_distance.x=1: "));
  EXPECT_THAT(Error({"task..x=1"}), HasSubstr("--set task..x=1: "));
}

// The shell splits a value at a blank.
TEST_F(OverrideTest, ReportsAnUnclosedBracket) {
  EXPECT_EQ(
      Error({"start.base_distance=[0.3,"}),
      "--set start.base_distance=[0.3,: its `[` is not closed: `]` is missing. An option with "
      "blanks stands in quotes: --set 'start.base_distance=[...]'");
  EXPECT_THAT(Error({"robot.base={kind: mocap, size: [1"}), HasSubstr("its `[` is not closed"));
  EXPECT_THAT(Error({"robot.base={kind: mocap"}), HasSubstr("'robot.base={...}'"));
  EXPECT_EQ(Load({"run='[a'"}).run, "[a");
}

TEST_F(OverrideTest, ProblemsOfTheFileKeepTheirPlaces) {
  Write("run.yaml", "run: r\nrobot: arm.yaml\ntsk: {}\noutput: o\n");
  EXPECT_THAT(Error({"seed=x"}), HasSubstr("run.yaml:3:1: tsk: "));
}

TEST_F(OverrideTest, AnOptionWithoutAnEqualsSignExplainsTheSyntax) {
  for (const char* text : {"seed", "=3", ""}) {
    ExpectThrow<ArgumentError>([&] { Load({text}); },
                               "--set " + std::string(text) + ": write it as path.to.field=value");
  }
}

TEST_F(OverrideTest, ProblemsOfTheRobotsFileNameThatFile) {
  Write("arm.yaml", "name: arm\nmodel: arm.xml\nraech: 1\nbase: {kind: mocp}\nreach: -1\n");
  const std::string robot = (folder_ / "arm.yaml").string();
  const std::string error = Error({});
  EXPECT_THAT(error, HasSubstr("3 problems:"));
  EXPECT_THAT(error, HasSubstr("\n  " + robot + ":3:1: robot.raech: "));
  EXPECT_THAT(error, HasSubstr("\n  " + robot + ":4:14: robot.base.kind: 'mocp' is not one of"));
  EXPECT_THAT(error, HasSubstr("\n  " + robot + ":5:8: robot.reach: -1 must be greater than 0"));
}

TEST_F(OverrideTest, AMissingRobotFileIsReportedAtItsReference) {
  EXPECT_THAT(Error({"robot=amr.yaml"}),
              ::testing::AllOf(HasSubstr("--set robot=amr.yaml: robot: "), HasSubstr("amr.yaml")));
}

}  // namespace
}  // namespace robocell
