#include "robocell/robot/group_factory.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/closed_loops.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/base_group.h"
#include "robocell/robot/base_pose_controller.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/suction_gripper.h"
#include "robocell/robot/wheeled_base.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/drive_matrix.h"
#include "robocell/scene/element_lookup.h"

namespace robocell::internal {
namespace {

// Describes what a joint has instead: "elbow ('push' on it is a motor)".
std::string WithItsActuators(const mjModel* m, const std::string& joint) {
  const int id = FindId(m, mjOBJ_JOINT, joint);
  for (int a = 0; a < m->nactuator; ++a) {
    if (!ActsOnJoint(m, a) || m->actuator_trnid[2 * a] != id) continue;
    return fmt::format("{} ('{}' on it is {})", joint, ElementName(m, mjOBJ_ACTUATOR, a),
                       DescribeActuator(m, a));
  }
  return joint;
}

// One actuator for each joint, or none and the reason why.
struct FoundActuators {
  std::vector<std::string> names = {};
  std::string why_none = {};
  bool incomplete = false;  // some joints have one
};

// Returns the actuators of an arm that act through tendons or on followers of its joints; none if
// one acts on each joint alone.
std::vector<int> DrivenTogether(const mjModel* m, const std::vector<std::string>& joints,
                                bool one_on_each) {
  std::vector<int> ids;
  for (const std::string& joint : joints) ids.push_back(FindId(m, mjOBJ_JOINT, joint));
  if (std::find(ids.begin(), ids.end(), -1) != ids.end()) return {};
  if (one_on_each && FollowersOf(m, ids).empty()) return {};
  return FindMatrixDrive(m, ids);
}

// Explains the first joint without an actuator that a loop moves.
std::string LoopAmong(const mjModel* m, const std::vector<std::string>& joints,
                      const ArmDrive& drive) {
  for (size_t i = 0; i < joints.size(); ++i) {
    if (!drive.names[i].empty()) continue;
    const std::string loop = DescribeLoopOf(m, FindId(m, mjOBJ_JOINT, joints[i]));
    if (loop.empty()) continue;
    return fmt::format(
        ". '{0}' is {1}, and an arm's joints are commanded one by one or follow one other each: "
        "put an actuator on '{0}', or write its coupling as <equality><joint joint1=\"{0}\" "
        "joint2=\"LEADER\"/></equality>",
        joints[i], loop);
  }
  return "";
}

FoundActuators ActuatorsOf(const mjModel* m, const std::vector<std::string>& joints) {
  ArmDrive drive = FindArmDrive(joints, JointActuators(m));
  const std::vector<int> together = DrivenTogether(m, joints, drive.complete());
  if (!together.empty()) {
    FoundActuators found;
    for (const int id : together) found.names.push_back(ElementName(m, mjOBJ_ACTUATOR, id));
    return found;
  }
  if (drive.complete()) return {std::move(drive.names)};
  std::vector<std::string> without;
  bool others = false;  // actuators of no kind
  for (size_t i = 0; i < joints.size(); ++i) {
    if (!drive.names[i].empty()) continue;
    without.push_back(WithItsActuators(m, joints[i]));
    others = others || without.back() != joints[i];
  }
  if (!drive.kind) {
    return {.why_none = std::string("it has no actuators: no position servo on its joints, no "
                                    "velocity servo and no motor") +
                        (others ? ": " + ListNames(without) : "")};
  }
  return {.why_none = fmt::format("{} of its joints {} no {}: {}{}", without.size(),
                                  without.size() == 1 ? "has" : "have", ActuatorWord(*drive.kind),
                                  ListNames(without), LoopAmong(m, joints, drive)),
          .incomplete = true};
}

MadeGroup MakeArmGroup(const Scene& scene, GroupNames names, const ChainTip& tip,
                       const std::string& why_no_actuators) {
  names.couples = true;
  const auto arm = std::make_shared<ArmGroup>(scene, names);
  return {arm, tip, why_no_actuators, FindDrives(scene, arm, std::move(names), why_no_actuators)};
}

// Makes one configured group.
class GroupMaker {
 public:
  GroupMaker(const Scene& scene, const RobotRecord& robot, const std::string& name,
             const MoveGroupConfig& config)
      : scene_(scene),
        robot_(robot),
        config_(config),
        place_("robot '" + robot.name + "' / group '" + name + "'") {
    const FrameName root{false, robot.root_body};
    names_ = {.robot = robot.name, .group = name, .root = root, .leaf = root, .robot_base = root};
  }

  MadeGroup Make() {
    for (const std::string& joint : config_.joints) names_.joints.push_back(robot_.prefix + joint);
    for (const std::string& actuator : config_.actuators) {
      names_.actuators.push_back(robot_.prefix + actuator);
    }
    if (config_.root) names_.root = Frame(*config_.root, {mjOBJ_BODY, mjOBJ_SITE});
    switch (config_.kind) {
      case MoveGroupKind::kArm:
        return MakeArm();
      case MoveGroupKind::kGripper:
        names_.leaf = LeafOr(ToolFrame());
        if (!config_.root) names_.root = TcpOfGripper();  // its fingers move about it
        return {MakeGripper()};
      case MoveGroupKind::kBase:
        return MakeBase();
      case MoveGroupKind::kGeneric:
        break;
    }
    names_.leaf = LeafOr(LastBody());
    return {std::make_shared<JointGroup>(scene_, names_, config_.kind)};
  }

  MadeGroup MakeBase() {
    names_.leaf = {false, robot_.base_body};
    const BaseKind base = robot_.base.kind;
    const bool moves_by_joints =
        base == BaseKind::kFree || base == BaseKind::kPlanar || base == BaseKind::kDriven;
    if (names_.joints.empty() && moves_by_joints) AddJointsOf(robot_.base_body);
    MadeGroup made{MakeBaseGroup(scene_, robot_, names_)};
    if (base == BaseKind::kDriven) {
      made.own_controller = kBasePoseController;
    } else if (dynamic_cast<const WheeledBase*>(made.group.get()) && !names_.actuators.empty()) {
      made.own_controller = UnicycleController::kKind;
    } else if (names_.actuators.empty()) {
      made.why_no_actuators = fmt::format(
          "it has no actuators. With `base: {{kind: driven}}` it moves to the poses that are "
          "commanded{}",
          base == BaseKind::kFixed ? "" : "; setting its `pose` teleports it");
    }
    return made;
  }

 private:
  const mjModel* model() const { return scene_.model(); }

  std::shared_ptr<MoveGroup> MakeGripper() {
    if (SuctionGripper::IsMadeOf(model(), names_.actuators))
      return std::make_shared<SuctionGripper>(scene_, names_, config_);
    return std::make_shared<ActuatedGripper>(scene_, names_, config_);
  }

  MadeGroup MakeArm() {
    names_.leaf = LeafOr(ToolFrame());
    FoundActuators found;
    if (names_.actuators.empty()) found = ActuatorsOf(model(), names_.joints);
    if (found.incomplete) {
      throw ArgumentError(
          fmt::format("{}: {}. Name the `actuators` that move it, one for each joint, or leave "
                      "those joints out",
                      place_, found.why_none));
    }
    if (names_.actuators.empty()) names_.actuators = found.names;
    const ChainTip tip =
        names_.leaf.is_site ? ChainTip::Site(names_.leaf.name) : ChainTip::Body(names_.leaf.name);
    return MakeArmGroup(scene_, names_, tip, found.why_none);
  }

  FrameName Frame(const ElementRef& ref, std::initializer_list<mjtObj> kinds) {
    const ElementId element = FindElement(model(), robot_, ref, kinds);
    return {element.kind == mjOBJ_SITE, ElementName(model(), element.kind, element.id)};
  }

  FrameName LeafOr(const FrameName& otherwise) {
    return config_.leaf ? Frame(*config_.leaf, {mjOBJ_SITE, mjOBJ_BODY}) : otherwise;
  }

  FrameName ToolFrame() const {
    if (robot_.tcp_site) return {true, *robot_.tcp_site};
    if (robot_.attachment_site) return {true, *robot_.attachment_site};
    return LastBody();
  }

  // Returns the gripper's own leaf, else that of the arm which carries it.
  FrameName TcpOfGripper() {
    if (config_.leaf) return names_.leaf;
    for (const auto& [name, group] : robot_.config.move_groups.entries()) {
      if (group->kind == MoveGroupKind::kArm && group->leaf && IsCarriedBy(*group))
        return Frame(*group->leaf, {mjOBJ_SITE, mjOBJ_BODY});
    }
    return names_.leaf;
  }

  // Returns true if the last joint of the gripper, or what its actuator acts on, comes after the
  // last joint of the arm.
  bool IsCarriedBy(const MoveGroupConfig& arm) const {
    const int own = BodyOfGripper();
    if (arm.joints.empty() || own < 0) return false;
    const int last = FindId(model(), mjOBJ_JOINT, robot_.prefix + arm.joints.names.back());
    return last >= 0 && IsInSubtree(model(), own, model()->jnt_bodyid[last]);
  }

  // Returns -1 if nothing says where it is.
  int BodyOfGripper() const {
    if (!names_.joints.empty())
      return model()->jnt_bodyid[RequireId(model(), mjOBJ_JOINT, names_.joints.back(), place_)];
    if (names_.actuators.empty()) return -1;
    return BodyOfActuator(model(),
                          RequireId(model(), mjOBJ_ACTUATOR, names_.actuators.back(), place_));
  }

  FrameName LastBody() const {
    if (names_.joints.empty()) return {false, robot_.root_body};
    const int joint = RequireId(model(), mjOBJ_JOINT, names_.joints.back(), place_);
    return {false, ElementName(model(), mjOBJ_BODY, model()->jnt_bodyid[joint])};
  }

  // A model's own free joint often has no name; the body can be moved without it.
  void AddJointsOf(const std::string& body) {
    const mjModel* m = model();
    const int id = RequireId(m, mjOBJ_BODY, body, place_);
    for (int j = 0; j < m->body_jntnum[id]; ++j) {
      std::string joint = ElementName(m, mjOBJ_JOINT, m->body_jntadr[id] + j);
      if (!joint.empty()) names_.joints.push_back(std::move(joint));
    }
  }

  const Scene& scene_;
  const RobotRecord& robot_;
  const MoveGroupConfig& config_;
  std::string place_;
  GroupNames names_;
};

}  // namespace

std::vector<MadeGroup> MakeGroups(const Scene& scene, const RobotRecord& robot) {
  std::vector<MadeGroup> groups;
  bool has_base = false;
  for (const auto& [name, config] : robot.config.move_groups.entries()) {
    GroupMaker maker(scene, robot, name, *config);
    groups.push_back(Located(robot.config, "move_groups." + name, [&] { return maker.Make(); }));
    has_base |= config->kind == MoveGroupKind::kBase || name == "base";
  }
  if (!has_base) groups.push_back(MakeImplicitBase(scene, robot));
  return groups;
}

MadeGroup MakeImplicitBase(const Scene& scene, const RobotRecord& robot) {
  const MoveGroupConfig config{.kind = MoveGroupKind::kBase};
  return GroupMaker(scene, robot, "base", config).MakeBase();
}

MadeGroup MakeAdHocArm(const Scene& scene, const RobotRecord& robot,
                       std::vector<std::string> joints, const ChainTip& tip) {
  const FrameName base{false, robot.root_body};
  GroupNames names{.robot = robot.name,
                   .group = "arm",
                   .joints = std::move(joints),
                   .root = base,
                   .leaf = {tip.kind == ChainTip::Kind::kSite, tip.name},
                   .robot_base = base};
  const FoundActuators found = ActuatorsOf(scene.model(), names.joints);
  if (found.incomplete) {
    LogWarn(fmt::format("robot '{}' / group 'arm' is not driven: {}", robot.name, found.why_none));
  }
  names.actuators = found.names;
  return MakeArmGroup(scene, std::move(names), tip, found.why_none);
}

}  // namespace robocell::internal
