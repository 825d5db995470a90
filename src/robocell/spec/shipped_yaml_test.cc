// Tests that every YAML file of robocell is valid, and that no key of it can be misspelled
// unnoticed.
#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "robocell/base/files.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/object_info.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

struct Key {
  std::string name;
  size_t offset;
  int line, column;  // from 1
  bool is_name;      // chosen by the author, such as a move group's
};

// Collects keys; the author chooses those in the next `names` levels.
void CollectKeys(const YAML::Node& node, int names, std::vector<Key>& out,
                 const std::string& inside = "") {
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) CollectKeys(item, 0, out);
  }
  if (!node.IsMap()) return;
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    const YAML::Mark mark = entry.first.Mark();
    out.push_back({name, static_cast<size_t>(mark.pos), mark.line + 1, mark.column + 1, names > 0});
    static const std::map<std::string, int> kNamed = {{"move_groups", 1},
                                                      {"home", 1},
                                                      {"home_noise", 1},
                                                      {"control", 1},
                                                      {"robots", 1},
                                                      {"grippers", 1},
                                                      {"gripper_offsets", 1},
                                                      {"robot_to_shared_base_frame", 1},
                                                      {"root_frame_objects", 1},
                                                      {"robot_frame_objects", 2},
                                                      {"camera_adds", 1}};
    // By patterns, or by names of cameras and bodies, which only a scene knows.
    if (name == "appearance" || name == "dynamics" || name == "sees" ||
        (name == "cameras" && inside == "start")) {
      for (const auto& target : entry.second) CollectKeys(target.second, 0, out);
      continue;
    }
    const auto named = kNamed.find(name);
    CollectKeys(entry.second, named == kNamed.end() ? std::max(names - 1, 0) : named->second, out,
                name);
  }
}

// Returns three typing errors: a letter lost, two swapped, one doubled.
std::set<std::string> Misspellings(const std::string& key) {
  std::set<std::string> out;
  const size_t middle = key.size() / 2;
  std::string lost = key, swapped = key, doubled = key;
  lost.erase(middle, 1);
  std::swap(swapped[middle - 1], swapped[middle]);
  doubled.insert(middle, 1, key[middle]);
  for (const std::string& text : {lost, swapped, doubled}) {
    if (text != key && text.size() > 1) out.insert(text);
  }
  return out;
}

using Parser = void (*)(const std::string& text, const std::string& folder);

template <class T>
void ParseShipped(const std::string& text, const std::string& folder) {
  ParseYaml<T>(text, "f.yaml", folder);
}

// The keys of a file show its kind.
Parser ParserFor(const std::string& text) {
  const YAML::Node root = YAML::Load(text);
  if (root["run"]) return ParseShipped<RunConfig>;
  if (root["model"]) return ParseShipped<RobotConfig>;
  if (root["category"]) return ParseShipped<ObjectInfo>;
  return root["robots"] && root["robots"].IsMap() ? ParseShipped<EnvConfig>
                                                  : ParseShipped<SceneSpec>;
}

std::string ErrorOf(const std::string& text, const std::string& folder, Parser parse) {
  try {
    parse(text, folder);
    return "";
  } catch (const SpecError& e) {
    return e.what();
  }
}

// Returns whether a name that the author chose is used elsewhere: as a key, or as a value but of a kind.
bool IsUsed(const Key& key, const std::string& text) {
  const std::regex use("(^|[^a-z_])(kind: )?" + key.name + "([^a-z_0-9]|$)");
  return std::any_of(std::sregex_iterator(text.begin(), text.end(), use), std::sregex_iterator(),
                     [&](const std::smatch& found) {
                       const auto at = static_cast<size_t>(found.position(3)) - key.name.size();
                       const bool is_field = found[3] == ":" && (at == 0 || text[at - 1] == '\n');
                       return at != key.offset && !found[2].matched && !is_field;
                     });
}

void ExpectEveryMisspellingIsNoticed(const std::string& text, const std::string& folder) {
  std::vector<Key> keys;
  CollectKeys(YAML::Load(text), 0, keys);
  ASSERT_FALSE(keys.empty());
  const bool is_env = ParserFor(text) == Parser(ParseShipped<EnvConfig>);
  static const std::regex kPlace(R"(\.yaml:\d+:\d+: )");
  for (const Key& key : keys) {
    if (key.is_name && (is_env || !IsUsed(key, text))) continue;  // may be any other name
    for (const std::string& wrong : Misspellings(key.name)) {
      std::string damaged = text;
      damaged.replace(key.offset, key.name.size(), wrong);
      const std::string error = ErrorOf(damaged, folder, ParserFor(text));
      ASSERT_NE(error, "") << key.line << ": '" << wrong << "' is taken for '" << key.name << "'";
      EXPECT_TRUE(std::regex_search(error, kPlace)) << error;
      EXPECT_THAT(error, ::testing::HasSubstr("Did you mean '")) << wrong;
      if (key.is_name) continue;  // reported where it is used
      EXPECT_THAT(error, ::testing::HasSubstr("f.yaml:" + std::to_string(key.line) + ":" +
                                              std::to_string(key.column) + ": "));
      EXPECT_THAT(error, ::testing::HasSubstr("Did you mean '" + key.name + "'?")) << wrong;
    }
  }
}

std::vector<fs::path> ShippedFiles() {
  std::vector<fs::path> files;
  for (const char* folder : {"examples", "models"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SourceDir()) / folder)) {
      if (entry.path().extension() != ".yaml") continue;
      // Files that need code of their own are read by tests/integration/test_own_tasks.py,
      // test_plugin.py, and those of several runs by python/tests/test_mixture.py.
      if (YAML::LoadFile(entry.path().string())["runs"]) continue;
      if (ImportsOfRunFile(entry.path().string()).empty()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

class ShippedYaml : public ::testing::TestWithParam<fs::path> {};

TEST_P(ShippedYaml, IsValid) {
  const std::string folder = GetParam().parent_path().string();
  const std::string text = ReadFile(GetParam());
  EXPECT_EQ(ErrorOf(text, folder, ParserFor(text)), "");
}

TEST_P(ShippedYaml, EveryMisspelledKeyIsReported) {
  ExpectEveryMisspellingIsNoticed(ReadFile(GetParam()), GetParam().parent_path().string());
}

INSTANTIATE_TEST_SUITE_P(All, ShippedYaml, ::testing::ValuesIn(ShippedFiles()),
                         [](const auto& info) {
                           const fs::path& file = info.param;
                           std::string name =
                               (file.parent_path().filename() / file.stem()).string();
                           return std::regex_replace(name, std::regex("[^A-Za-z0-9]"), "_");
                         });

// A robot and its dataset as a user would write them for a real arm.
constexpr const char* kRobot = R"(# xarm7.yaml
name: xarm7
model: menagerie:ufactory_xarm7/xarm7.xml
edits:
  - {body: link_base, pos: [0, 0, 0]}
  - {site: link_tcp, xyaxes: [-1, 0, 0, 0, -1, 0]}
  - {add_camera: exo_camera,   body: link_base, pos: [0.05, 0.3, 0.4], quat_wxyz: [0.353553, 0.146447, -0.353553, -0.853553], fovy: 71}
  - {add_camera: wrist_camera, body: xarm_gripper_base_link, pos: [-0.07, 0, 0], quat_wxyz: [0.061628, 0.704416, -0.704416, -0.061628], fovy: 52}
root_body: link_base
base: {kind: mocap, size: [0.25, 0.25, 0.25]}
move_groups:
  arm:     {kind: arm, joints: joint1..joint7, actuators: act1..act7, leaf: {site: link_tcp}}
  gripper: {kind: gripper, joints: [left_driver_joint, right_driver_joint], actuators: [gripper], leaf: {site: link_tcp},
            fingers: [left_finger_pad_2, right_finger_pad_2], ctrl: {open: 0, closed: 255}, distance: {closed: 0.004, open: 0.089}}
home: {arm: [0, 0, 0, 0, 0, 0, 0], gripper: [0, 0]}
control: {arm: joint_position, gripper: joint_position}
gravcomp: true
)";

constexpr const char* kRun = R"(# xarm7_pick.yaml
run: xarm7_pick
robot: xarm7.yaml
task: {kind: pick}
start: {base_distance: [0.15, 0.6], base_height_offset: -0.25, base_height_noise: [-0.2, 0.2]}
scenes: {source: procedural, houses: 0..3}          # or {source: tabletop}, {source: procthor-10k, root: …}, {files: [lab.xml]}
episodes_per_scene: 2
cameras: {resolution: [624, 352], streams: [{name: wrist, camera: wrist_camera}, {name: exo, camera: exo_camera}]}
rates: {policy_ms: 66, control_ms: 2, sim_ms: 2, max_steps: 500}
workers: 4
seed: 0
output: experiment_output/xarm7_pick_v1
)";

std::string ExamplesFolder() { return SourceDir() + "/examples"; }

std::string RunWithScenes(const std::string& scenes) {
  return std::regex_replace(kRun, std::regex(R"(\{source: procedural, houses: 0\.\.3\})"), scenes);
}

TEST(CustomRobot, IsReadAsWritten) {
  const auto robot = ParseYaml<RobotConfig>(kRobot);
  EXPECT_EQ(robot.name, "xarm7");
  EXPECT_EQ(robot.edits.size(), 4u);
  EXPECT_EQ(robot.edits[2].fovy, 71);
  EXPECT_NEAR((*robot.edits[2].quat)[3], 0.353553, 1e-5);
  EXPECT_EQ(robot.base.size, (Vec3{0.25, 0.25, 0.25}));
  EXPECT_EQ(robot.move_groups.at("arm").joints.names.back(), "joint7");
  EXPECT_EQ(robot.move_groups.at("gripper").ctrl->closed, 255);
  EXPECT_EQ(robot.gravcomp, true);
}

TEST(CustomRobot, EveryMisspelledKeyIsReported) { ExpectEveryMisspellingIsNoticed(kRobot, ""); }

TEST(CustomRobot, RunIsReadAsWritten) {
  const auto run = ParseYaml<RunConfig>(RunWithScenes("{source: tabletop, houses: 0..3}"), "f.yaml",
                                        ExamplesFolder());
  EXPECT_EQ(run.robot.config.name, "xarm7");
  EXPECT_EQ(run.scenes.houses.size(), 4u);
  EXPECT_EQ(run.rates.control_ticks(), 33);
  EXPECT_EQ(run.cameras.streams[1].camera, "exo_camera");
}

TEST(CustomRobot, EveryMisspelledKeyOfTheRunIsReported) {
  ExpectEveryMisspellingIsNoticed(RunWithScenes("{source: tabletop, houses: 0..3}"),
                                  ExamplesFolder());
}

TEST(CustomRobot, SceneFilesNeedNoSource) {
  const auto run =
      ParseYaml<RunConfig>(RunWithScenes("{files: [lab.xml]}"), "f.yaml", ExamplesFolder());
  EXPECT_EQ(run.scenes.kind(), "files");
  EXPECT_EQ(run.scenes.As<FilesScenes>().files.size(), 1u);
}

TEST(CustomRobot, AMissingSceneSourceErrorListsTheSources) {
  for (const std::string source : {"procedural", "procthor-10k"}) {
    EXPECT_THAT(ErrorOf(RunWithScenes("{source: " + source + ", root: x}"), ExamplesFolder(),
                        ParseShipped<RunConfig>),
                ::testing::AllOf(
                    ::testing::HasSubstr("f.yaml:6:18: scenes.source: no scene source '" + source),
                    ::testing::HasSubstr("files, houses, tabletop")));
  }
}

}  // namespace
}  // namespace robocell
