#include "robocell/scene/robot_base.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

constexpr float kPedestalColour[4] = {0.32f, 0.33f, 0.36f, 1.0f};

void AddPedestal(mjsBody* body, const Vec3& size, const std::string& prefix,
                 const std::string& place) {
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  SetSpecName(geom->element, prefix + "pedestal", place);
  geom->type = mjGEOM_BOX;
  for (int i = 0; i < 3; ++i) geom->size[i] = size[i] / 2;
  geom->pos[2] = size[2] / 2;
  std::copy_n(kPedestalColour, 4, geom->rgba);
}

void AddPlanarJoints(mjsBody* body, const std::string& prefix, const std::string& place) {
  const struct {
    const char* name;
    mjtJoint type;
    int axis;
  } joints[] = {
      {"base_x", mjJNT_SLIDE, 0}, {"base_y", mjJNT_SLIDE, 1}, {"base_yaw", mjJNT_HINGE, 2}};
  for (const auto& [name, type, axis] : joints) {
    mjsJoint* joint = mjs_addJoint(body, nullptr);
    SetSpecName(joint->element, prefix + name, place);
    joint->type = type;
    for (int i = 0; i < 3; ++i) joint->axis[i] = i == axis ? 1 : 0;
  }
}

// Returns true if a body moves in a plane by joints of its own: two level slides in different
// directions and an upright hinge, in any order.
bool HasPlanarJoints(mjsBody* body) {
  constexpr double kLevel = 1e-6, kApart = 1e-3;  // of unit axes
  std::vector<Eigen::Vector3d> slides, hinges;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 0); e; e = mjs_nextChild(body, e, 0)) {
    const mjsJoint* joint = mjs_asJoint(e);
    if (joint->type != mjJNT_SLIDE && joint->type != mjJNT_HINGE) return false;
    const Eigen::Vector3d axis = Eigen::Vector3d(joint->axis).normalized();
    (joint->type == mjJNT_SLIDE ? slides : hinges).push_back(axis);
  }
  return slides.size() == 2 && hinges.size() == 1 && std::abs(slides[0].z()) < kLevel &&
         std::abs(slides[1].z()) < kLevel && hinges[0].head<2>().norm() < kLevel &&
         slides[0].cross(slides[1]).norm() > kApart;
}

// Returns true if a model that can move freely drives over the floor on wheels of its own.
bool HasWheels(const RobotPart& robot, const BaseConfig& base) {
  if (base.kind != BaseKind::kPlanar || base.size || !FreeJointOf(robot.top)) return false;
  return std::ranges::any_of(robot.record.config.move_groups.entries(), [](const auto& entry) {
    return entry.second->kind == MoveGroupKind::kBase && entry.second->joints.size() >= 2;
  });
}

// Returns true if the model moves in a plane by itself, so that no base is made for it.
bool MovesInPlane(const RobotPart& robot, const BaseConfig& base) {
  if (base.kind != BaseKind::kPlanar || base.size) return false;
  return HasPlanarJoints(robot.top) || HasWheels(robot, base);
}

// The weld is so stiff that a base sags by less than 0.1 mm under a hand and its load: at rest the
// engine lets it give way by (1 - d) / d of the load over the stiffness 1 / (d t)^2.
constexpr double kWeldTime = 0.01;        // t, seconds
constexpr double kWeldImpedance = 0.999;  // d
// The least time constant in timesteps. The engine's own bound is 2, where a hand with stiff
// fingers shakes its base for ever.
constexpr double kWeldSteps = 3;

// The engine scales a weld by the mass of the held body itself. A body without mass of its own
// would sag by centimetres, whatever hangs on it.
void AddMass(mjsBody* body) {
  body->explicitinertial = 1;
  std::fill_n(body->ipos, 3, 0.0);  // without a position the engine ignores the mass
  body->mass = 1e-3;
  std::fill_n(body->inertia, 3, 1e-6);
}

// Adds the mocap body that moves the base body, at the same place.
void AddTarget(mjsBody* world, const std::string& base, const Pose& pose, const RobotRecord& robot,
               const std::string& place) {
  mjsBody* target = mjs_addBody(world, nullptr);
  SetSpecName(target->element, robot.base_target(), place);
  SetPose(target, pose);
  target->mocap = true;
  mjsEquality* weld = mjs_addEquality(mjs_getSpec(world->element), nullptr);
  SetSpecName(weld->element, robot.base_weld(), place);
  weld->type = mjEQ_WELD;
  weld->objtype = mjOBJ_BODY;
  mjs_setString(weld->name1, robot.base_target().c_str());
  mjs_setString(weld->name2, base.c_str());
  std::fill_n(weld->data, mjNEQDATA, 0.0);  // anchored at the origin
  weld->data[6] = 1;                        // the relative pose is the identity
  weld->data[10] = 1;                       // angles count like metres
  weld->solref[0] = kWeldTime;
  weld->solimp[0] = weld->solimp[1] = kWeldImpedance;
}

}  // namespace

std::optional<std::string> BaseBodyName(const BaseConfig& base, const std::string& prefix) {
  if (base.kind == BaseKind::kFixed && !base.size) return std::nullopt;
  return prefix + ToString(base.kind) + "_base";
}

void FitWeld(mjSpec* scene, const RobotRecord& robot) {
  if (robot.base.kind != BaseKind::kDriven) return;
  mjsElement* weld = mjs_findElement(scene, mjOBJ_EQUALITY, robot.base_weld().c_str());
  if (!weld) return;
  mjtNum& time = mjs_asEquality(weld)->solref[0];
  time = std::max<mjtNum>(time, kWeldSteps * scene->option.timestep);
}

void SettleBase(RobotPart& robot, CompileLog& log) {
  RobotRecord& record = robot.record;
  // A model that moves itself does so also where the spec takes the base away.
  if (record.base.kind == BaseKind::kFixed && MovesInPlane(robot, record.config.base))
    record.base = record.config.base;
  if (record.base.size) record.pedestal_height = (*record.base.size)[2];
  const auto made = BaseBodyName(record.base, record.prefix);
  if (record.base.kind == BaseKind::kMocap) record.mocap_body = made;
  const std::string top = SpecName(robot.top->element);
  if (MovesInPlane(robot, record.base)) {
    record.top_body = record.base_body = top.empty() ? record.root_body : record.prefix + top;
    return;
  }
  record.base_body = made ? *made : top.empty() ? record.root_body : record.prefix + top;
  if (!FreeJointOf(robot.top)) return;
  if (made) {
    log.Problem(
        robot.part.place,
        fmt::format("the model's root '{}' has a free joint of its own, so its base cannot be {}; "
                    "delete the joint in `edits` or leave the base out{}",
                    SpecName(robot.top->element), ToString(record.base.kind),
                    record.base.kind == BaseKind::kPlanar && !record.base.size
                        ? ". For a base on wheels, name their joints and actuators in a group of "
                          "kind `base`"
                        : ""),
        "base");
  }
  record.base.kind = BaseKind::kFree;
}

std::optional<Placement> AddBase(const RobotSpec& robot, const RobotPart& loaded,
                                 const Placement& placement, CompileLog& log) {
  const BaseConfig& base = loaded.record.base;
  const std::string& place = loaded.part.place;
  const bool free_root = FreeJointOf(loaded.top) != nullptr;
  const bool moves_itself = free_root || MovesInPlane(loaded, base);
  const auto name = moves_itself ? std::nullopt : BaseBodyName(base, robot.prefix);
  std::optional<Placement> at = placement;
  if (base.kind != BaseKind::kFixed) {
    at = PlaceInWorld(placement, robot.attach_to, std::string("a ") + ToString(base.kind) + " base",
                      place, log);
  }
  if (!at || !name) return at;
  mjsBody* body = mjs_addBody(at->parent, nullptr);
  SetSpecName(body->element, *name, place);
  SetPose(body, at->pose);
  body->mocap = base.kind == BaseKind::kMocap;
  if (base.kind == BaseKind::kDriven) AddTarget(at->parent, *name, at->pose, loaded.record, place);
  if (base.kind == BaseKind::kFree || base.kind == BaseKind::kDriven)
    SetSpecName(mjs_addFreeJoint(body)->element, robot.prefix + "base_free", place);
  if (base.kind == BaseKind::kPlanar) AddPlanarJoints(body, robot.prefix, place);
  if (base.kind == BaseKind::kDriven && !base.size) AddMass(body);
  if (base.size) AddPedestal(body, *base.size, robot.prefix, place);
  return Placement{body, Pose(Eigen::Vector3d(0, 0, loaded.record.pedestal_height))};
}

}  // namespace robocell::internal
