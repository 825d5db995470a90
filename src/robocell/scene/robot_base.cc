#include "robocell/scene/robot_base.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

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

// Returns true if a body moves in a plane by joints of its own: slides along x and y and a hinge about
// z, in this order.
bool HasPlanarJoints(mjsBody* body) {
  int found = 0;
  for (mjsElement* e = mjs_firstChild(body, mjOBJ_JOINT, 0); e; e = mjs_nextChild(body, e, 0)) {
    const mjsJoint* joint = mjs_asJoint(e);
    if (found == 3 || joint->type != (found < 2 ? mjJNT_SLIDE : mjJNT_HINGE)) return false;
    for (int i = 0; i < 3; ++i)
      if (std::abs(joint->axis[i] - (i == found ? 1 : 0)) > 1e-9) return false;
    ++found;
  }
  return found == 3;
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
  if (record.base.kind == BaseKind::kFixed && record.config.base.kind == BaseKind::kPlanar &&
      !record.config.base.size && HasPlanarJoints(robot.top))
    record.base = record.config.base;
  if (record.base.size) record.pedestal_height = (*record.base.size)[2];
  const auto made = BaseBodyName(record.base, record.prefix);
  if (record.base.kind == BaseKind::kMocap) record.mocap_body = made;
  const std::string top = SpecName(robot.top->element);
  if (record.base.kind == BaseKind::kPlanar && !record.base.size && HasPlanarJoints(robot.top)) {
    record.top_body = record.base_body = top.empty() ? record.root_body : record.prefix + top;
    return;
  }
  record.base_body = made ? *made : top.empty() ? record.root_body : record.prefix + top;
  if (!FreeJointOf(robot.top)) return;
  if (made) {
    log.Problem(
        robot.part.place,
        fmt::format("the model's root '{}' has a free joint of its own, so its base cannot be {}; "
                    "delete the joint in `edits` or leave the base out",
                    SpecName(robot.top->element), ToString(record.base.kind)),
        "base");
  }
  record.base.kind = BaseKind::kFree;
}

std::optional<Placement> AddBase(const RobotSpec& robot, const RobotPart& loaded,
                                 const Placement& placement, CompileLog& log) {
  const BaseConfig& base = loaded.record.base;
  const std::string& place = loaded.part.place;
  const bool free_root = FreeJointOf(loaded.top) != nullptr;
  const bool moves_itself =
      free_root || (base.kind == BaseKind::kPlanar && !base.size && HasPlanarJoints(loaded.top));
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
