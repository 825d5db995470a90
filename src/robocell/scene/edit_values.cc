#include "robocell/scene/edit_values.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "robocell/base/units.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/add_camera.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

class ValueEditor {
 public:
  ValueEditor(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log)
      : edit_(edit), element_(element), place_(place), log_(log) {}

  void Apply() {
    switch (element_->elemtype) {
      case mjOBJ_BODY:
        return ChangeBody(mjs_asBody(element_));
      case mjOBJ_SITE:
        return ChangeSite(mjs_asSite(element_));
      case mjOBJ_JOINT:
        return ChangeJoint(mjs_asJoint(element_));
      case mjOBJ_GEOM:
        return ChangeGeom(mjs_asGeom(element_));
      case mjOBJ_CAMERA:
        return ChangeCamera(mjs_asCamera(element_));
      case mjOBJ_ACTUATOR:
        return ChangeActuator(mjs_asActuator(element_));
      default:
        return;
    }
  }

 private:
  void Problem(std::string_view field, const std::string& message) {
    log_.Problem(place_, message, field);
  }
  std::string Name() const { return DescribeSpecElement(element_); }

  bool turns() const { return edit_.quat || edit_.euler || edit_.xyaxes; }
  bool moves() const { return edit_.pos || turns(); }

  void ChangeBody(mjsBody* body) {
    ChangePose(body);
    if (edit_.mass) SetMass(SetBodyMass(body, *edit_.mass));
  }

  void ChangeSite(mjsSite* site) {
    if (moves() || edit_.size) ResolveFromTo(site);
    ChangePose(site);
    ChangeLook(site);
  }

  void ChangeGeom(mjsGeom* geom) {
    if (edit_.size && HasSizeOfAsset(geom)) {
      return Problem("size", fmt::format("the size of {} is that of its mesh or height field; "
                                         "scale that in the file (<mesh scale=\"...\">)",
                                         Name()));
    }
    if (moves() || edit_.size) ResolveFromTo(geom);
    ChangePose(geom);
    ChangeLook(geom);
    if (edit_.mass) SetMass(SetGeomMass(geom, *edit_.mass));
    if (edit_.friction) std::copy(edit_.friction->begin(), edit_.friction->end(), geom->friction);
    if (edit_.condim) geom->condim = *edit_.condim;
  }

  // Returns true for a primitive that is fitted to a mesh too.
  static bool HasSizeOfAsset(const mjsGeom* geom) {
    return geom->type == mjGEOM_MESH || geom->type == mjGEOM_SDF || geom->type == mjGEOM_HFIELD ||
           !std::string_view(mjs_getString(geom->meshname)).empty();
  }

  void SetMass(const std::optional<std::string>& problem) {
    if (problem) Problem("mass", *problem);
  }

  template <class Placed>
  void ChangePose(Placed* element) {
    if (!moves()) return;
    const bool framed = mjs_getFrame(element_) != nullptr;
    const Pose before = framed ? PoseInParent(element_) : Pose();
    if (edit_.pos) std::copy(edit_.pos->begin(), edit_.pos->end(), element->pos);
    if (edit_.xyaxes) {
      mjs_defaultOrientation(&element->alt);
      element->alt.type = mjORIENTATION_XYAXES;
      std::copy(edit_.xyaxes->begin(), edit_.xyaxes->end(), element->alt.xyaxes);
    } else if (turns()) {
      const Vec3 none{};
      SetPose(element,
              Pose(Eigen::Vector3d(element->pos), PlacementPose(none, edit_.euler.value_or(none),
                                                                edit_.quat.value_or(kIdentityQuat))
                                                      .quaternion()));
    }
    if (framed) GoOutOfFrame(before, element);
  }

  // The edit's values are in the parent body; the file's frames around the element do not apply.
  template <class Placed>
  void GoOutOfFrame(const Pose& before, Placed* element) {
    const Pose in_frame = OwnPose(element_);
    const Pose frame = FramePoseInParent(element_);
    const Pose& place = edit_.pos ? in_frame : before;
    const Pose& rotation = turns() ? in_frame : before;
    SetPose(element, frame.inverse() * Pose(place.translation(), rotation.quaternion()));
  }

  template <class Shown>
  void ChangeLook(Shown* element) {
    if (edit_.size) std::copy(edit_.size->begin(), edit_.size->end(), element->size);
    if (!edit_.rgba) return;
    std::transform(edit_.rgba->begin(), edit_.rgba->end(), element->rgba,
                   [](double c) { return static_cast<float>(c); });
    mjs_setString(element->material, "");
  }

  void ChangeCamera(mjsCamera* camera) {
    const bool aims = camera->mode == mjCAMLIGHT_TARGETBODY ||  //
                      camera->mode == mjCAMLIGHT_TARGETBODYCOM;
    if (turns() && aims) {
      return Problem(edit_.quat    ? "quat"
                     : edit_.euler ? "euler"
                                   : "xyaxes",
                     fmt::format("{} always looks at body '{}', so it cannot be turned; add a "
                                 "camera of its own with add_camera",
                                 Name(), mjs_getString(camera->targetbody)));
    }
    if (edit_.fovy && camera->sensor_size[1] > 0) {
      return Problem("fovy", fmt::format("the fovy of {} is that of its focal length and "
                                         "sensorsize; change these in the file",
                                         Name()));
    }
    ChangePose(camera);
    if (edit_.fovy) SetFovy(camera, *edit_.fovy, place_, log_);
  }

  void ChangeJoint(mjsJoint* joint) {
    if (joint->type == mjJNT_FREE && (edit_.pos || edit_.range)) {
      return Problem(edit_.pos ? "pos" : "range",
                     fmt::format("{} is a free joint, which has no {}; it moves its body anywhere",
                                 Name(), edit_.pos ? "pos" : "range"));
    }
    if (edit_.pos) SetJointPos(joint);
    if (edit_.range) SetJointRange(joint);
    if (edit_.damping) SetJointDamping(joint);
    if (edit_.armature) joint->armature = *edit_.armature;
    if (edit_.frictionloss) joint->frictionloss = *edit_.frictionloss;
  }

  void SetJointPos(mjsJoint* joint) {
    const Eigen::Vector3d pos(edit_.pos->data());
    const Eigen::Vector3d in_frame =
        (FramePoseInParent(element_).inverse() * Pose(pos)).translation();
    std::copy_n(in_frame.data(), 3, joint->pos);
  }

  // The model may use degrees; an edit uses radians.
  void SetJointRange(mjsJoint* joint) {
    const bool degrees = mjs_getCompiler(joint->element)->degree && joint->type != mjJNT_SLIDE;
    for (int i = 0; i < 2; ++i)
      joint->range[i] = degrees ? Degrees((*edit_.range)[i]) : (*edit_.range)[i];
    joint->limited = mjLIMITED_TRUE;
  }

  void SetJointDamping(mjsJoint* joint) {
    if (joint->springdamper[0] > 0 && joint->springdamper[1] > 0) {
      return Problem("damping", fmt::format("the engine works the damping of {} out from its "
                                            "springdamper; change that in the file",
                                            Name()));
    }
    joint->damping[0] = *edit_.damping;
  }

  void ChangeActuator(mjsActuator* actuator) {
    if (edit_.ctrlrange) {
      std::copy(edit_.ctrlrange->begin(), edit_.ctrlrange->end(), actuator->ctrlrange);
      actuator->ctrllimited = mjLIMITED_TRUE;
      if (actuator->dyntype != mjDYN_INTEGRATOR) actuator->inheritrange = 0;  // is for ctrlrange
    }
    if (edit_.forcerange) {
      std::copy(edit_.forcerange->begin(), edit_.forcerange->end(), actuator->forcerange);
      actuator->forcelimited = mjLIMITED_TRUE;
    }
    if ((edit_.kp || edit_.kv) && !SetServoGains({.kp = edit_.kp, .kv = edit_.kv}, actuator)) {
      Problem(edit_.kp ? "kp" : "kv",
              fmt::format("{} is {}: kp is a gain of position servos, kv of these and of velocity "
                          "servos; leave it out, or write the actuator as <position> or <velocity> "
                          "in the file",
                          Name(), DescribeActuator(actuator)));
    }
  }

  const Edit& edit_;
  mjsElement* element_;
  const std::string& place_;
  CompileLog& log_;
};

bool IsFromGeoms(mjsBody* body) {
  const mjtInertiaFromGeom from = mjs_getCompiler(body->element)->inertiafromgeom;
  return from == mjINERTIAFROMGEOM_TRUE ||
         (from == mjINERTIAFROMGEOM_AUTO && !body->explicitinertial);
}

bool HasVolume(const mjsGeom* geom) {
  return geom->type != mjGEOM_PLANE && geom->type != mjGEOM_HFIELD;
}

bool IsInWeighedGroup(const mjsGeom* geom) {
  const int* range = mjs_getCompiler(geom->element)->inertiagrouprange;
  return geom->group >= range[0] && geom->group <= range[1];
}

// Returns the geoms that make up the mass of their body.
std::vector<mjsGeom*> Weighed(mjsBody* body) {
  std::vector<mjsGeom*> geoms;
  for (mjsElement* element : BodyElements(body, mjOBJ_GEOM)) {
    mjsGeom* geom = mjs_asGeom(element);
    const double weight = std::isnan(geom->mass) ? geom->density : geom->mass;
    if (HasVolume(geom) && IsInWeighedGroup(geom) && weight > 0) geoms.push_back(geom);
  }
  return geoms;
}

std::string GeomMassEdit(mjsBody* body) {
  return fmt::format("{{geom: {{body: '{}', index: 0}}, mass: ...}}", SpecName(body->element));
}

std::optional<std::string> SetMassOfGeoms(mjsBody* body, double mass) {
  const std::vector<mjsGeom*> geoms = Weighed(body);
  const std::string name = DescribeSpecElement(body->element);
  if (geoms.empty()) {
    return fmt::format(
        "{} has neither an <inertial> nor geoms with a mass, so nothing in it "
        "can carry its mass; write an <inertial> into the file, or give a geom a mass: "
        "{}",
        name, GeomMassEdit(body));
  }
  if (geoms.size() == 1) return geoms[0]->mass = mass, std::nullopt;
  double sum = 0;
  for (const mjsGeom* geom : geoms) sum += geom->mass;
  if (std::isnan(sum)) {
    return fmt::format(
        "{} has no <inertial>: its mass is that of its {} geoms, of which not all say "
        "theirs; write it geom by geom: {}, or an <inertial> into the file",
        name, geoms.size(), GeomMassEdit(body));
  }
  for (mjsGeom* geom : geoms) geom->mass *= mass / sum;
  return std::nullopt;
}

void SetMassOfInertial(mjsBody* body, double mass) {
  if (body->mass > 0) {
    const double scale = mass / body->mass;
    for (double& inertia : body->inertia) inertia *= scale;
    for (double& inertia : body->fullinertia) inertia *= scale;
  }
  body->mass = mass;
}

// Returns true for position servos, and for those that integrate their control to a position.
bool HoldsPosition(const mjsActuator* actuator) {
  return actuator->gaintype == mjGAIN_FIXED && actuator->gainprm[0] != 0 &&
         actuator->biastype == mjBIAS_AFFINE && actuator->biasprm[1] < 0;
}

}  // namespace

void SetEdited(const Edit& edit, mjsElement* element, const std::string& place, CompileLog& log) {
  ValueEditor(edit, element, place, log).Apply();
}

std::optional<std::string> SetBodyMass(mjsBody* body, double mass) {
  if (const double least = mjs_getCompiler(body->element)->boundmass; mass < least) {
    return fmt::format(
        "the file's <compiler boundmass=\"{}\"> raises all masses below it, that of {} "
        "too; write at least {}, or change boundmass in the file",
        least, DescribeSpecElement(body->element), least);
  }
  if (IsFromGeoms(body)) return SetMassOfGeoms(body, mass);
  SetMassOfInertial(body, mass);
  return std::nullopt;
}

std::optional<std::string> SetGeomMass(mjsGeom* geom, double mass) {
  mjsBody* body = mjs_getParent(geom->element);
  const std::string name = DescribeSpecElement(geom->element);
  if (!IsFromGeoms(body)) {
    return fmt::format(
        "the mass of {} does not count, that of its body is written as <inertial>; "
        "write {{body: '{}', mass: ...}}",
        name, SpecName(body->element));
  }
  if (!HasVolume(geom)) {
    return fmt::format(
        "{} is a plane or a height field, which has no mass; give it to another geom", name);
  }
  if (!IsInWeighedGroup(geom)) {
    const int* range = mjs_getCompiler(geom->element)->inertiagrouprange;
    return fmt::format(
        "{} is in group {}, and the file's <compiler inertiagrouprange=\"{} {}\"> counts "
        "other geoms only; give the mass to one of these",
        name, geom->group, range[0], range[1]);
  }
  geom->mass = mass;
  return std::nullopt;
}

bool SetServoGains(const ServoGains& gains, mjsActuator* actuator) {
  const bool of_velocity = ActuatorKind(actuator) == CtrlMode::kVelocity;
  if (!HoldsPosition(actuator) && (gains.kp || !of_velocity)) return false;
  if (gains.kp) {
    const double authored = -actuator->biasprm[1];  // first, so that a ratio of one stays exact
    actuator->gainprm[0] = *gains.kp * (actuator->gainprm[0] / authored);
    actuator->biasprm[0] = *gains.kp * (actuator->biasprm[0] / authored);
    actuator->biasprm[1] = -*gains.kp;
  }
  if (gains.kv) actuator->biasprm[2] = -*gains.kv;
  if (gains.kv && of_velocity) actuator->gainprm[0] = *gains.kv;
  return true;
}

}  // namespace robocell::internal
