#include "robocell/mujoco/actuators.h"

#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

int BodyOfTendon(const mjModel* m, int tendon) {
  const int first = m->tendon_adr[tendon];
  for (int wrap = first; wrap < first + m->tendon_num[tendon]; ++wrap) {
    if (const int body = BodyOfWrap(m, wrap); body >= 0) return body;
  }
  return -1;
}

}  // namespace

double TendonArmature(const mjModel* m, int tendon) {
  double sum = m->tendon_armature[tendon];
  for (int a = 0; a < m->nactuator; ++a) {
    if (m->actuator_trntype[a] != mjTRN_TENDON || m->actuator_trnid[2 * a] != tendon) continue;
    const double gear = Gear(m, a);
    sum += gear * gear * m->actuator_armature[a];
  }
  return sum;
}

int BodyOfWrap(const mjModel* m, int wrap) {
  const int id = m->wrap_objid[wrap];
  switch (m->wrap_type[wrap]) {
    case mjWRAP_JOINT:
      return m->jnt_bodyid[id];
    case mjWRAP_SITE:
      return m->site_bodyid[id];
    case mjWRAP_SPHERE:
    case mjWRAP_CYLINDER:
      return m->geom_bodyid[id];
    default:
      return -1;
  }
}

ActuatorTarget TargetOf(const mjModel* m, int actuator) {
  const int *ids = m->actuator_trnid + 2 * actuator, id = *ids;
  switch (m->actuator_trntype[actuator]) {
    case mjTRN_JOINT:
    case mjTRN_JOINTINPARENT:
      return {mjOBJ_JOINT, id};
    case mjTRN_SITE:
    case mjTRN_SLIDERCRANK:
      return {mjOBJ_SITE, id};
    case mjTRN_SO3:  // a ball joint, or a site and its reference site
      return {ids[1] < 0 ? mjOBJ_JOINT : mjOBJ_SITE, id};
    case mjTRN_TENDON:
      return {mjOBJ_TENDON, id};
    case mjTRN_BODY:
      return {mjOBJ_BODY, id};
    default:
      return {mjOBJ_UNKNOWN, -1};
  }
}

int BodyOfActuator(const mjModel* m, int actuator) {
  const auto [kind, id] = TargetOf(m, actuator);
  return kind == mjOBJ_TENDON ? BodyOfTendon(m, id) : BodyOf(m, kind, id);
}

}  // namespace robocell::internal
