#include "robocell/scene/add_robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/guard.h"
#include "robocell/scene/robot_base.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/validate_model_file.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/shared_parts.h"

namespace robocell::internal {
namespace {

// Puts a robot's prefix in front of the names that its elements have in a model of several robots.
class Prefixer {
 public:
  explicit Prefixer(const std::string& prefix) : prefix_(prefix) {}

  void Add(std::string& name) const {
    if (!name.empty()) name.insert(0, prefix_);
  }
  void Add(NameList& list) const {
    for (std::string& name : list.names) Add(name);
  }
  void Add(ElementRef& ref) const {
    Add(ref.name);
    Add(ref.body);
  }
  void Add(std::vector<ElementRef>& refs) const {
    for (ElementRef& ref : refs) Add(ref);
  }
  template <class T>
  void Add(std::optional<T>& name) const {
    if (name) Add(*name);
  }
  void Add(MoveGroupConfig& group) const {
    Add(group.joints);
    Add(group.actuators);
    Add(group.root);
    Add(group.leaf);
    Add(group.fingers);
  }
  // The sensor keeps its own name, which is not the name of an element.
  void Add(ForceTorqueSensorSpec& sensor) const {
    sensor.force_sensor = prefix_ + sensor.force();
    sensor.torque_sensor = prefix_ + sensor.torque();
    Add(sensor.frame_site);
  }

 private:
  const std::string& prefix_;
};

// Puts `prefix` in front of every name of an element: root body, groups, sites, geoms, sensors.
// Edits, attachments and cameras stay as they are.
RobotConfig WithPrefix(RobotConfig config, const std::string& prefix) {
  if (prefix.empty()) return config;
  const Prefixer prefixer(prefix);
  prefixer.Add(config.root_body);
  for (const auto& [name, group] : config.move_groups.entries()) prefixer.Add(*group);
  prefixer.Add(config.attachment_site);
  prefixer.Add(config.collision_geoms);
  for (ForceTorqueSensorSpec& sensor : config.ft_sensors) prefixer.Add(sensor);
  return config;
}

constexpr const char* kRootLabel = "root_body";

// Derives a robot's name from its prefix.
std::string StrippedPrefix(std::string prefix) {
  while (!prefix.empty() && (prefix.back() == '_' || prefix.back() == '/')) prefix.pop_back();
  std::replace(prefix.begin(), prefix.end(), '/', '_');  // not allowed in names
  return prefix;
}

RobotConfig ConfigOf(const RobotSpec& robot) {
  if (robot.config) return WithPrefix(*robot.config, robot.model_prefix);
  RobotConfig config;
  config.model = robot.path;
  return config;
}

// Calls LoadPart for a model that must have joints.
std::optional<Part> LoadRobotModel(const std::string& name, const std::string& directory,
                                   const std::string& place, const std::string& field,
                                   const SimOptions& options, CompileLog& log) {
  const auto file = FindModel(name, directory, place, field, log);
  if (!file) return std::nullopt;
  const size_t before = log.problem_count();
  ValidateIsModel(*file, place, field, log);
  if (log.problem_count() > before) return std::nullopt;
  return LoadPart(*file, directory, place, field, options, kRootLabel, log, UrdfServos::kAll);
}

// Checks a model of several robots, where each robot's names have a prefix of their own.
bool HasNamesOf(const RobotSpec& robot, const Part& part, const std::string& name,
                CompileLog& log) {
  if (robot.model_prefix.empty()) return true;
  std::vector<std::string> bodies = SpecNames(part.spec.get(), mjOBJ_BODY);
  for (const std::string& body : bodies) {
    if (body.starts_with(robot.model_prefix)) return true;
  }
  std::erase(bodies, "world");
  log.Problem(RobotPlace(name),
              fmt::format("in {} the names of robot '{}' must begin with '{}'; its "
                          "bodies are {}",
                          part.file, name, robot.model_prefix, ListNames(bodies)),
              "model");
  return false;
}

// Returns the robot's root body: the configured one, else its highest one.
std::string RootOf(const RobotSpec& robot, const RobotPart& part) {
  if (!part.record.config.root_body.empty()) return part.record.config.root_body;
  for (const std::string& body : SpecNames(part.part.spec.get(), mjOBJ_BODY)) {  // parents first
    if (!robot.model_prefix.empty() && body.starts_with(robot.model_prefix)) return body;
  }
  return SpecName(part.top->element);
}

// Arms that name no actuators use those that the model has on their joints.
bool AreGroupsApart(const RobotConfig& config, const Part& robot, CompileLog& log) {
  std::vector<GroupParts> groups;
  for (const auto& [name, group] : config.move_groups.entries()) {
    GroupParts parts{
        .name = name, .joints = group->joints.names, .actuators = group->actuators.names};
    if (group->kind == MoveGroupKind::kArm && parts.actuators.empty()) {
      parts.actuators = ArmActuators(*group, robot.spec.get());
      parts.names_actuators = false;
    }
    groups.push_back(std::move(parts));
  }
  const std::vector<SharedParts> found = FindSharedParts(groups);
  for (const SharedParts& shared : found)
    log.Problem(robot.place, shared.field + ": " + shared.message, shared.field);
  return found.empty();
}

// A body that moves by hand hangs on the world; a base of robocell's carries the robot instead.
void DropMocap(RobotPart& out, CompileLog& log) {
  const BaseConfig& base = out.record.base;
  if (!out.top->mocap || !BaseBodyName(base, out.record.prefix)) return;
  out.top->mocap = false;
  log.Note(out.part.place,
           fmt::format("the model's root '{}' is a mocap body, and hangs on the robot's {} base "
                       "instead",
                       SpecName(out.top->element), ToString(base.kind)));
}

// Adds the parts of the robot's configuration to its model in `out`.
void FillRobot(const RobotSpec& robot, const Locations& locations, const SceneSpec& scene,
               RobotPart& out, CompileLog& log) {
  RobotRecord& record = out.record;
  const RobotConfig& config = record.config;
  const std::string& directory = config.source_dir.empty() ? scene.source_dir : config.source_dir;
  const std::string top = SpecName(out.top->element);
  const std::string root = RootOf(robot, out);
  const bool configured = !config.move_groups.empty();
  if (!configured) out.limbs = SerialLimbs(out.part.spec.get(), robot.control_modes.has_value());
  AddAttachments(config.attachments, config.locations, directory, out.part, scene, log);
  AddAttachments(robot.attachments, locations, scene.source_dir, out.part, scene, log);
  AddRobotCameras(config, directory, out.part, scene, log);
  ApplyOverrides(config, out.part, log);
  if (record.base.kind == BaseKind::kFixed)
    ExcludeFirstJoints(out.top, scene.options, out.part.spec.get());
  // Actuators for other modes of a shared joint would be added twice.
  if (configured && AreGroupsApart(config, out.part, log))
    out.limbs = ConfiguredLimbs(config, out.part.spec.get());
  out.limbs =
      AddModeActuators(robot, std::move(out.limbs), out.part.place, out.part.spec.get(), log);
  if (const auto tcp = AddTcpSite(config, out.part, log)) record.tcp_site = robot.prefix + *tcp;
  record.top_body = BaseBodyName(record.base, robot.prefix).value_or(robot.prefix + top);
  record.root_body = robot.prefix + root;
  if (config.attachment_site) record.attachment_site = robot.prefix + *config.attachment_site;
  DropMocap(out, log);
  SettleBase(out, log);
  // In a model of several robots this robot is the subtree of its own root.
  if (!robot.model_prefix.empty()) record.top_body = record.base_body = record.root_body;
}

// Returns what the spec says of the root's pose in its file, or else the robot's own file.
std::optional<bool> DropsRootPose(const RobotSpec& robot, const RobotRecord& record) {
  return robot.reset_root_pose ? robot.reset_root_pose : record.config.reset_root_pose;
}

// Returns the pose of the root on its base: the one of the model's file, unless it is to be
// dropped. A root off its own origin would stand beside its pedestal.
Pose RootPose(const RobotSpec& robot, const RobotPart& loaded) {
  const std::optional<bool> reset = DropsRootPose(robot, loaded.record);
  if (reset.value_or(false)) return {};
  const Pose authored = PoseInParent(loaded.top->element);
  if (reset || !loaded.record.base.size) return authored;
  return {{0, 0, authored.translation().z()}, authored.quaternion()};
}

// Lends the model of one robot to another that fills it in, and whose place problems have
// meanwhile; an exception returns it to the first robot too.
class LentPart {
 public:
  LentPart(Part& from, Part& to, const std::string& place) : from_(from), to_(to) {
    std::swap(from_, to_);
    from_.place = std::exchange(to_.place, place);
  }
  ~LentPart() {
    std::swap(from_, to_);
    std::swap(from_.place, to_.place);
    to_.field = from_.field;
    to_.file = from_.file;
  }
  LentPart(const LentPart&) = delete;
  LentPart& operator=(const LentPart&) = delete;

 private:
  Part &from_, &to_;
};

// Locates a robot in a scene's file and in its own file, which has no place in a scene.
void LocateRobot(const RobotRecord& record, const Locations& in_scene, CompileLog& log) {
  log.Locate(RobotPlace(record.name), in_scene);
  log.Locate(RobotPlace(record.name), record.config.locations, FieldNames<RobotConfig>());
}

}  // namespace

std::string RobotPlace(const std::string& name) { return "robot '" + name + "'"; }

std::vector<std::string> RobotNames(const List<RobotSpec>& robots, CompileLog& log) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  int unnamed = 0;
  for (const RobotSpec& robot : robots) {
    std::string name = robot.name.value_or(StrippedPrefix(robot.prefix));
    if (name.empty()) {
      name = unnamed == 0 ? "robot" : fmt::format("robot_{}", unnamed);
      ++unnamed;
    }
    if (!taken.insert(name).second) {
      log.Problem(RobotPlace(name),
                  "two robots have this name; set `name` or give them different prefixes");
    }
    names.push_back(name);
  }
  return names;
}

RobotRecord RecordOf(const RobotSpec& robot, const std::string& name) {
  RobotRecord record;
  record.name = name;
  record.prefix = robot.prefix;
  record.config = ConfigOf(robot);
  record.base = robot.EffectiveBase();
  return record;
}

std::optional<RobotPart> LoadRobot(const RobotSpec& robot, const std::string& name,
                                   const Locations& locations, const SceneSpec& scene,
                                   CompileLog& log) {
  const std::string place = RobotPlace(name);
  RobotPart out;
  RobotRecord& record = out.record;
  record = RecordOf(robot, name);
  const RobotConfig& config = record.config;
  const std::string& directory = config.source_dir.empty() ? scene.source_dir : config.source_dir;
  LocateRobot(record, locations, log);
  auto part = LoadRobotModel(config.model, directory, place, robot.config ? "model" : "path",
                             scene.options, log);
  if (!part) return std::nullopt;
  out.part = std::move(*part);
  if (!HasNamesOf(robot, out.part, name, log)) return std::nullopt;
  if (config.home.empty() && !out.part.other_keys.empty()) log.Note(place, out.part.other_keys);
  ApplyEdits(config, out.part, log);
  out.top = ChooseRoot(out.part, config.root_body, log);
  if (!out.top) return std::nullopt;
  FillRobot(robot, locations, scene, out, log);
  return out;
}

std::optional<RobotPart> LoadRobotIn(RobotPart& host, const RobotSpec& robot,
                                     const std::string& name, const Locations& locations,
                                     const SceneSpec& scene, CompileLog& log) {
  RobotPart out;
  out.record = RecordOf(robot, name);
  out.top = host.top;
  LocateRobot(out.record, locations, log);
  if (!HasNamesOf(robot, host.part, name, log)) return std::nullopt;
  {
    const LentPart lent(host.part, out.part, RobotPlace(name));
    FillRobot(robot, locations, scene, out, log);
  }
  return out;
}

void AttachRobot(const RobotSpec& robot, RobotPart& loaded, const Placement& placement,
                 CompileLog& log) {
  const auto mount = AddBase(robot, loaded, placement, log);
  if (!mount) return;
  AttachPart(mount->parent, loaded.part, loaded.top, mount->pose * RootPose(robot, loaded),
             robot.prefix, log);
  const bool stands = DropsRootPose(robot, loaded.record).value_or(false);
  loaded.part.keys.PlaceFree(mount->pose, stands ? FreeKeys::kHeightAndTilt : FreeKeys::kWhole);
}

}  // namespace robocell::internal
