// Makes robots: from their configuration in the scene, or ad hoc from two bodies.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/robot/group_factory.h"
#include "robocell/robot/robot_state.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr const char* kDefaultControl = "joint_position";

// Returns a record for a robot without one, or whose configuration is not used. It keeps what the
// scene knows of the robot's base.
RobotRecord AdHocRecord(const Scene& scene, const std::string& prefix,
                        const std::string& base_body) {
  const mjModel* m = scene.model();
  const int root = RequireId(m, mjOBJ_BODY, prefix + base_body, "scene '" + scene.name() + "'");
  RobotRecord record;
  record.name = prefix.empty() ? "robot" : prefix;
  record.base_body = prefix + base_body;
  for (const RobotRecord& known : scene.compiled()->robots()) {
    if (known.prefix != prefix) continue;
    if (internal::IsInSubtree(m, root, FindId(m, mjOBJ_BODY, known.base_body))) record = known;
  }
  record.config = {};
  record.prefix = prefix;
  record.root_body = prefix + base_body;
  return record;
}

ChainTip TipOf(const Scene& scene, const std::string& tip_body, const RobotOptions& options) {
  const std::string place = "scene '" + scene.name() + "'";
  const std::string& site = options.tool.tcp_site;
  RequireId(scene.model(), mjOBJ_BODY, options.prefix + tip_body, place);
  if (site.empty()) return ChainTip::Body(options.prefix + tip_body);
  RequireId(scene.model(), mjOBJ_SITE, options.prefix + site, place);
  return ChainTip::Site(options.prefix + site);
}

}  // namespace

Robot Robot::Of(const Scene& scene, const std::string& name) {
  const size_t slash = name.rfind('/');
  const RobotRecord& as_configured = scene.compiled()->robot(name.substr(0, slash));
  std::string key = "robot:" + as_configured.name;
  std::string arm = slash == std::string::npos ? "" : name.substr(slash + 1);
  if (slash != std::string::npos) {
    const std::vector<std::string> arms = internal::ArmNames(as_configured.config);
    if (std::ranges::find(arms, arm) == arms.end()) {
      throw NotFoundError(
          NoSuchName(fmt::format("scene '{}' / robot '{}'", scene.name(), as_configured.name),
                     "arm", arm, arms));
    }
    if (arm == arms.front()) arm.clear();
    if (!arm.empty()) key += "/" + arm;
  }
  if (auto known = std::dynamic_pointer_cast<State>(scene.FindObserver(key))) {
    return Robot(scene, std::move(known));
  }
  RobotRecord record = as_configured;
  if (!arm.empty()) record.config = internal::WithArmFirst(record.config, arm);
  auto state = std::make_shared<State>(scene, record);
  for (internal::MadeGroup& made : internal::MakeGroups(scene, record)) {
    const std::string group = made.group->name();
    const ControlKind* control = record.config.control.find(group);
    internal::Located(record.config, (control ? "control." : "move_groups.") + group, [&] {
      state->AddGroup(std::move(made), control ? ToString(*control) : kDefaultControl,
                      control != nullptr);
    });
  }
  // Whatever arm it is seen from, it is one robot: each group has one controller and one command.
  if (!arm.empty()) state->ShareControls(*Robot::Of(scene, record.name).state_);
  Scene(scene).KeepObserver(state, key);
  return Robot(scene, std::move(state));
}

Robot Robot::FromScene(const Scene& scene, const std::string& base_body,
                       const std::string& tip_body, const RobotOptions& options) {
  RequireValid(options.tool, "tool");
  RobotRecord record = AdHocRecord(scene, options.prefix, base_body);
  record.config.ft_sensors = options.tool.ft_sensors;
  const std::string& tool = options.tool.tool_body;
  const ChainOptions chain_options{.tool_body = tool.empty() ? "" : options.prefix + tool};
  const ChainTip tip = TipOf(scene, tip_body, options);
  const Chain chain(scene.model(), record.root_body, tip, chain_options);
  auto state = std::make_shared<State>(scene, record, chain_options);
  state->tip_body = options.prefix + tip_body;
  internal::MadeGroup arm = internal::MakeAdHocArm(scene, record, chain.joint_names(), tip);
  const CtrlMode native = arm.drives->native.value_or(CtrlMode::kPosition);
  state->AddGroup(std::move(arm), internal::PortController(native), false);
  state->AddGroup(internal::MakeImplicitBase(scene, record), kDefaultControl, false);
  Scene(scene).AddObserver(state);
  return Robot(scene, std::move(state));
}

std::vector<Robot> RobotsOf(const Scene& scene) {
  std::vector<Robot> robots;
  for (const RobotRecord& record : scene.compiled()->robots()) {
    if (!record.config.move_groups.empty()) robots.push_back(Robot::Of(scene, record.name));
  }
  return robots;
}

}  // namespace robocell
