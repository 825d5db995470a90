#include "robocell/rollout/source_demos.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/replay.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {
namespace {

constexpr size_t kPoseSize = 7;
constexpr double kQuaternionTolerance = 0.01;
// Largest difference of played controls from the record: more moves a grasp.
constexpr double kReplayMetres = 0.002, kReplayRadians = 0.02;

bool Has(const Episode& episode, const std::string& column) {
  return std::ranges::any_of(episode.columns(),
                             [&](const ColumnInfo& info) { return info.spec.name == column; });
}

// Returns the part of a column's name between two texts; unset for another name.
std::optional<std::string> Between(const std::string& name, const std::string& before,
                                   const std::string& after) {
  if (!name.starts_with(before) || !name.ends_with(after)) return std::nullopt;
  if (name.size() <= before.size() + after.size()) return std::nullopt;
  const std::string part = name.substr(before.size(), name.size() - before.size() - after.size());
  return part.find('/') == std::string::npos ? std::optional(part) : std::nullopt;
}

enum class IfInvalid { kThrow, kWarn };

// Returns the poses of a column; empty if there is none. Throws ArgumentError for a column of another
// shape. A row that is no pose is an error too, or a warning: the column is then not used.
std::vector<Pose> ReadPoses(const Episode& episode, const std::string& column,
                            IfInvalid if_invalid = IfInvalid::kThrow) {
  if (!Has(episode, column)) return {};
  const std::vector<int64_t>& shape = episode.column(column).spec.shape;
  if (shape != std::vector<int64_t>{static_cast<int64_t>(kPoseSize)}) {
    throw ArgumentError(fmt::format(
        "episode '{}': column {} has rows of shape {}; a pose is 7 numbers, x y z and the "
        "quaternion x y z w. A mapping file of `robocell import` can give the column another name",
        episode.folder().string(), column, ShapeText(shape)));
  }
  const std::vector<double> numbers = ReadSteps<double>(episode, column);
  std::vector<Pose> poses;
  for (size_t i = 0; i + kPoseSize <= numbers.size(); i += kPoseSize) {
    const std::span<const double> pose = std::span(numbers).subspan(i, kPoseSize);
    const Eigen::Map<const Eigen::Vector4d> quaternion(pose.data() + 3);
    const bool is_finite = std::ranges::all_of(pose, [](double x) { return std::isfinite(x); });
    if (!is_finite || std::abs(quaternion.norm() - 1) > kQuaternionTolerance) {
      const std::string what =
          fmt::format("episode '{}': row {} of column {} is no pose: [{:.6g}]",
                      episode.folder().string(), i / kPoseSize, column, fmt::join(pose, ", "));
      if (if_invalid == IfInvalid::kThrow) throw ArgumentError(what);
      LogWarn(what + ". The column is not used");
      return {};
    }
    poses.emplace_back(Eigen::Vector3d(pose[0], pose[1], pose[2]),
                       Quaternion{pose[3], pose[4], pose[5], pose[6]});
  }
  return poses;
}

// Returns the robot of an episode by its columns.
std::string RobotOf(const Episode& episode, const std::string& named) {
  std::set<std::string> robots;
  for (const ColumnInfo& info : episode.columns()) {
    for (const char* pose : {"/tcp_pose", "/tcp_pose_in_base"}) {
      if (const auto robot = Between(info.spec.name, "robots/", pose)) robots.insert(*robot);
    }
  }
  if (robots.contains(named) || robots.empty()) return named;
  if (robots.size() == 1) return *robots.begin();
  throw ArgumentError(NoSuchName("episode '" + episode.folder().string() + "'", "robot", named,
                                 {robots.begin(), robots.end()}));
}

std::vector<double> ReadOpening(const Episode& episode, const std::string& path) {
  for (const ColumnInfo& info : episode.columns()) {
    if (Between(info.spec.name, path + "action/", "") &&
        info.spec.names == std::vector<std::string>{"opening"})
      return ReadSteps<double>(episode, info.spec.name);
  }
  return {};
}

// Changes poses in the base frame into poses in the world, row by row.
std::vector<Pose> ToWorld(const std::vector<Pose>& bases, std::vector<Pose> in_base) {
  for (size_t row = 0; row < in_base.size(); ++row) in_base[row] = bases[row] * in_base[row];
  return in_base;
}

void ReadTcp(const Episode& episode, const std::string& path, Demonstration& demo) {
  demo.base_in_world = ReadPoses(episode, path + "base_pose");
  if (demo.base_in_world.empty())
    demo.base_in_world.assign(static_cast<size_t>(episode.rows()), Pose());
  demo.tcp_in_world = ReadPoses(episode, path + "tcp_pose");
  if (demo.tcp_in_world.empty())
    demo.tcp_in_world = ToWorld(demo.base_in_world, ReadPoses(episode, path + "tcp_pose_in_base"));
  // What the expert wanted, without the noise that it corrects later.
  for (const char* target : {"intended/tcp_pose", "action/tcp_pose"}) {
    if (demo.target_in_world.empty())
      demo.target_in_world = ToWorld(demo.base_in_world, ReadPoses(episode, path + target));
  }
  if (!demo.target_in_world.empty() || demo.tcp_in_world.empty()) return;
  // Without commands the hand was sent to where it went.
  demo.target_in_world.assign(demo.tcp_in_world.begin() + 1, demo.tcp_in_world.end());
  demo.target_in_world.push_back(demo.tcp_in_world.back());
}

void ReadPhases(const Episode& episode, Demonstration& demo) {
  if (!Has(episode, "phase")) return;
  demo.phases = episode.column("phase").spec.values;
  if (demo.phases.empty()) return;
  for (const int32_t phase : ReadSteps<int32_t>(episode, "phase")) {
    if (phase < 0 || static_cast<size_t>(phase) >= demo.phases.size()) {
      throw IoError(fmt::format("episode '{}': a phase is {}, and it has names for {}",
                                episode.folder().string(), phase, demo.phases.size()));
    }
    demo.phase.push_back(phase);
  }
}

double TickOf(const Episode& episode) {
  if (const auto rates = EpisodeJson::Metadata(episode).Find("rates")) {
    const auto policy = rates->Find("policy_ms");
    if (policy && policy->value().is_number() && policy->value().get<double>() > 0)
      return policy->value().get<double>() / 1000;
  }
  if (Has(episode, "time")) {
    const std::vector<double> times = ReadSteps<double>(episode, "time");
    if (times.size() > 1 && times.back() > times.front())
      return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  }
  throw ArgumentError(fmt::format(
      "episode '{}' does not say how long a row lasts: its metadata need rates.policy_ms, or it "
      "needs a column 'time'",
      episode.folder().string()));
}

// Returns the bodies that hinges and slides outside of robots move, by id.
std::vector<int> ArticulatedBodies(const Scene& scene) {
  std::set<int> of_robots;
  for (const Robot& robot : RobotsOf(scene))
    of_robots.insert(robot.body_ids().begin(), robot.body_ids().end());
  const mjModel* m = scene.model();
  std::set<int> bodies;
  for (int joint = 0; joint < m->njnt; ++joint) {
    const bool turns = m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
    const int body = m->jnt_bodyid[joint];
    if (turns && !of_robots.contains(body) && !ElementName(m, mjOBJ_BODY, body).empty())
      bodies.insert(body);
  }
  return {bodies.begin(), bodies.end()};
}

// Throws Error if the played scene is not where the record has the hand and the objects in a row.
void RequireAsRecorded(const Demonstration& demo, const Scene& scene, const Robot& robot,
                       int64_t row) {
  const auto require = [&](const std::string& column, const Pose& recorded, const Pose& played) {
    if (played.is_close(recorded, kReplayRadians, kReplayMetres)) return;
    throw Error(fmt::format("row {} of column {} is {:.3g} m and {:.3g} rad away from the record",
                            row, column, (played.translation() - recorded.translation()).norm(),
                            (recorded.inverse() * played).angle()));
  };
  const auto at = static_cast<size_t>(row);
  require("robots/" + robot.name() + "/tcp_pose", demo.tcp_in_world[at], robot.tcp_in_world());
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    const auto recorded = demo.bodies.find(object.name);
    if (recorded == demo.bodies.end()) continue;
    require("objects/" + object.name + "/pose", recorded->second[at],
            scene.body_pose(object.root_body));
  }
}

// Returns the poses of the bodies that joints of objects move. Throws Error if the record does not
// follow from its controls here.
std::map<std::string, std::vector<Pose>> PlayArticulatedBodies(const Episode& episode,
                                                               const std::string& robot,
                                                               const Demonstration& demo) {
  std::map<std::string, std::vector<Pose>> moving;
  std::vector<int> bodies;
  std::optional<Robot> arm;
  int64_t rows = 0;
  PlayControls(episode, [&](const Scene& scene, int64_t row) {
    if (row == 0) bodies = ArticulatedBodies(scene);
    if (row == 0 && !bodies.empty()) arm = Robot::Of(scene, robot);
    if (bodies.empty()) return false;
    RequireAsRecorded(demo, scene, *arm, row);
    for (const int body : bodies) {
      const std::string name = ElementName(scene.model(), mjOBJ_BODY, body);
      moving[name].push_back(scene.body_pose(name));
    }
    ++rows;
    return true;
  });
  if (!bodies.empty() && rows < episode.rows())
    throw Error(fmt::format("the simulation diverges in row {}", rows));
  return moving;
}

void AddArticulatedBodies(const Episode& episode, const std::string& robot, Demonstration& demo) {
  demo.root_in_world =
      EpisodeJson::Metadata(episode).At("scene_spec").AsSpec<SceneSpec>().root_frame_to_world;
  try {
    for (auto& [name, poses] : PlayArticulatedBodies(episode, robot, demo))
      demo.bodies.insert_or_assign(name, std::move(poses));
  } catch (const Error& error) {
    LogWarn(fmt::format(
        "episode '{}': its drawers, doors and other jointed bodies are not used, as the played "
        "controls do not give the record here: {}. `robocell replay` compares both",
        episode.folder().string(), error.what()));
  }
}

[[noreturn]] void ThrowNoSegments(const RunConfig& run) {
  throw ArgumentError(fmt::format(
      "'{}': in none of its episodes a part was found in which the hand moves something",
      run.augment->dataset));
}

}  // namespace

std::vector<std::string> SourceIds(const AugmentConfig& augment) {
  const Dataset dataset(augment.dataset);
  if (!augment.episodes.names.empty()) return dataset.Select(augment.episodes.names).ids();
  std::vector<std::string> ids;
  for (const Episode& episode : dataset) {
    if (episode.success()) ids.push_back(episode.id());
  }
  if (!ids.empty()) return ids;
  throw ArgumentError(
      fmt::format("'{}' has no successful episode; name some that show the task as "
                  "`augment.episodes`, or make others",
                  augment.dataset));
}

Demonstration ReadDemonstration(const Episode& episode, const std::string& robot,
                                bool plays_controls) {
  Demonstration demo{.episode = episode.id(), .tick = TickOf(episode)};
  const std::string name = RobotOf(episode, robot), path = "robots/" + name + "/";
  ReadTcp(episode, path, demo);
  if (demo.tcp_in_world.empty()) {
    throw ArgumentError(fmt::format(
        "episode '{}' has no column {}tcp_pose or {}tcp_pose_in_base: nothing says where its hand "
        "was. A mapping file of `robocell import` can give one that name",
        episode.folder().string(), path, path));
  }
  demo.opening = ReadOpening(episode, path);
  ReadPhases(episode, demo);
  for (const ColumnInfo& info : episode.columns()) {
    const auto object = Between(info.spec.name, "objects/", "/pose");
    if (!object) continue;
    std::vector<Pose> poses = ReadPoses(episode, info.spec.name, IfInvalid::kWarn);
    if (!poses.empty()) demo.bodies[*object] = std::move(poses);
  }
  if (const auto kinds = EpisodeJson::Metadata(episode).Find("object_kinds");
      kinds && kinds->value().is_array() && !kinds->Items().empty())
    demo.object_kind = kinds->Items().front().AsText();
  const bool has_scene = EpisodeJson::Metadata(episode).Find("scene_spec").has_value();
  if (has_scene && plays_controls) AddArticulatedBodies(episode, name, demo);
  if (demo.bodies.empty() && (plays_controls || !has_scene)) {
    throw ArgumentError(fmt::format(
        "episode '{}' has no column objects/<object>/pose: nothing says what its motions refer to",
        episode.folder().string()));
  }
  demo.segments = FindSegments(demo);
  return demo;
}

void RequireSources(const RunConfig& run) {
  const Dataset dataset(run.augment->dataset);
  const std::string& robot = run.robot.config.name;
  bool is_found = false;
  for (const std::string& id : SourceIds(*run.augment)) {
    const Episode episode = dataset.Open(id);
    is_found |= !ReadDemonstration(episode, robot, false).segments.empty();
    is_found = is_found || !ReadDemonstration(episode, robot).segments.empty();
  }
  if (!is_found) ThrowNoSegments(run);
}

Demonstrations ReadSources(const RunConfig& run) {
  const Dataset dataset(run.augment->dataset);
  auto demos = std::make_shared<std::vector<Demonstration>>();
  std::vector<std::string> empty;
  int unlabelled = 0;
  for (const std::string& id : SourceIds(*run.augment)) {
    Demonstration demo = ReadDemonstration(dataset.Open(id), run.robot.config.name);
    unlabelled += !HasSegmentLabels(demo);
    if (demo.segments.empty())
      empty.push_back(id);
    else
      demos->push_back(std::move(demo));
  }
  if (!empty.empty() && !demos->empty()) {
    LogWarn(fmt::format("'{}': in {} no part was found in which the hand moves something; not used",
                        run.augment->dataset, ListNames(empty, 3)));
  }
  if (unlabelled > 0) {
    LogInfo(fmt::format(
        "'{}': {} of {} source episodes have no phases of motions through free space: their parts "
        "are those around the gripper's opening and closing",
        run.augment->dataset, unlabelled, demos->size() + empty.size()));
  }
  if (demos->empty()) ThrowNoSegments(run);
  return demos;
}

}  // namespace robocell::internal
