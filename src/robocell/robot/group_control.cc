#include "robocell/robot/group_control.h"

#include "robocell/kinematics/kdl_segments.h"

namespace robocell::internal {
namespace {

std::string ControlKey(const MoveGroup& arm) {
  std::string key(kControlKey);
  for (const auto* names : {&arm.joint_names(), &arm.actuator_names()}) {
    for (const std::string& name : *names) key += name + '\n';
  }
  return key;
}

bool IsSame(const KdlSegment& a, const KdlSegment& b) {
  return a.name == b.name && a.joint == b.joint && a.motion == b.motion && a.origin == b.origin &&
         a.axis == b.axis && a.offset == b.offset && a.armature == b.armature &&
         a.tip.rotation == b.tip.rotation && a.tip.translation == b.tip.translation &&
         a.mass == b.mass && a.centre == b.centre && a.inertia == b.inertia;
}

bool IsSame(const Chain& a, const Chain& b) {
  const std::vector<KdlSegment> left = KdlSegments(a), right = KdlSegments(b);
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](const KdlSegment& l, const KdlSegment& r) { return IsSame(l, r); });
}

}  // namespace

ControlledGroup::ControlledGroup(const Scene& scene, MadeGroup made, std::string root_body,
                                 const ChainOptions& options)
    : group(std::move(made.group)),
      drives(made.drives ? std::move(*made.drives) : OwnDrive(group)),
      arm(dynamic_cast<const ArmGroup*>(group.get())),
      gripper(dynamic_cast<GripperGroup*>(group.get())),
      base(dynamic_cast<BaseGroup*>(group.get())),
      tip(std::move(made.tip)),
      root_body_(std::move(root_body)),
      tool_body_(options.tool_body) {
  if (made.drives && group->nu() > 0) control_key_ = ControlKey(*group);
  RemakeChain(scene.model());
  for (const auto& drive : drives.groups) {
    if (auto* driven = dynamic_cast<ArmGroup*>(drive.get())) driven->UseChain(&chain);
  }
}

void ControlledGroup::RemakeChain(const mjModel* model, std::span<const double> qpos) {
  if (!tip) return;
  Chain made(model, root_body_, *tip, {.tool_body = tool_body_, .qpos = qpos});
  if (chain && chain->companion()) {
    if (IsSame(*chain, made)) {
      made.companion() = chain->companion();
    } else {
      companions_.push_back(chain->companion());
    }
  }
  chain.emplace(std::move(made));
  source_ = ChainSource(model, *chain);
  refreshed_ = !qpos.empty();
}

// Grippers continue to their commanded opening, wherever they are.
ServoGroup* GroupControl::PositionServos() const {
  if (controller->mode() != CtrlMode::kPosition || drive->kind() == MoveGroupKind::kGripper)
    return nullptr;
  return dynamic_cast<ServoGroup*>(drive);
}

void GroupControl::SettleLags(std::span<const double> q) {
  if (ServoGroup* servos = PositionServos()) servos->SettleLags(q);
}

void GroupControl::Reset() {
  placed_at_.reset();
  controller->Reset();
  ports.Reseed(*of->group);
  if (ServoGroup* servos = PositionServos()) servos->SettleLags(drive->joint_pos());
}

void GroupControl::PlaceAt(double time) {
  Reset();
  Guarded([](GroupControl& control) { control.Run(); });
  placed_at_ = time;
}

void GroupControl::Put(std::shared_ptr<Controller> next, std::shared_ptr<ControlledGroup> group,
                       MoveGroup& its_drive) {
  if (controller) controller->UsePort({});
  ports.Connect(*next);
  Replace(std::move(group), std::move(next), &its_drive);
}

void GroupControl::Replace(std::shared_ptr<ControlledGroup> group, std::shared_ptr<Controller> next,
                           MoveGroup* its_drive) {
  Replaced replaced{std::exchange(of, std::move(group)),
                    std::exchange(controller, std::move(next))};
  drive = its_drive;
  ctrl.resize(drive ? static_cast<size_t>(drive->nu()) : 0);
  if (running_ > 0) replaced_.push_back(std::move(replaced));
}

void GroupControl::PutBack(Driven before) {
  if (controller) controller->UsePort({});
  ports.PutBack(before.ports, before.controller.get());
  Replace(std::move(before.of), std::move(before.controller), before.drive);
}

}  // namespace robocell::internal
