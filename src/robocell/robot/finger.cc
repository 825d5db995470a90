#include "robocell/robot/finger.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/tool_elements.h"

namespace robocell::internal {
namespace {

constexpr int kLooksAtAJaw = 16;    // over its range
constexpr double kNearHinge = 0.4;  // share of the jaw's length

bool Collides(const mjModel* m, int geom) {
  return m->geom_contype[geom] != 0 || m->geom_conaffinity[geom] != 0;
}

std::vector<int> GeomsWeldedTo(const mjModel* m, int body) {
  std::vector<int> geoms;
  for (int g = 0; g < m->ngeom; ++g) {
    if (m->body_weldid[m->geom_bodyid[g]] == m->body_weldid[body]) geoms.push_back(g);
  }
  return geoms;
}

// Returns a body's own colliding geoms; those welded to it if it has none; any of them if none
// collides.
std::vector<int> MeasuredGeoms(const mjModel* m, int body) {
  const std::vector<int> welded = GeomsWeldedTo(m, body);
  std::vector<int> own, colliding;
  for (const int g : welded) {
    if (!Collides(m, g)) continue;
    colliding.push_back(g);
    if (m->geom_bodyid[g] == body) own.push_back(g);
  }
  return !own.empty() ? own : !colliding.empty() ? colliding : welded;
}

Finger MakeFinger(const mjModel* m, ElementId element) {
  Finger finger;
  switch (element.kind) {
    case mjOBJ_GEOM:
      finger.body = m->geom_bodyid[element.id];
      finger.geoms = {element.id};
      return finger;
    case mjOBJ_SITE:
      finger.sites = {element.id};
      finger.body = m->site_bodyid[element.id];
      break;
    default:
      finger.body = element.id;
      finger.is_body = true;
  }
  finger.geoms = MeasuredGeoms(m, finger.body);
  return finger;
}

// Returns the child of the hand that carries a body.
int BranchOf(const mjModel* m, int hand, int body) {
  while (m->body_parentid[body] != hand) body = m->body_parentid[body];
  return body;
}

// Marks the branch of `to` if `from` is marked and nothing forbids it.
bool Grow(const mjModel* m, int hand, int other_finger, int from, int to, std::vector<bool>& mask) {
  if (!mask[from] || mask[to] || to == hand || !IsInSubtree(m, to, hand)) return false;
  const std::vector<bool> branch = SubtreeMask(m, BranchOf(m, hand, to));
  if (branch[other_finger]) return false;
  for (size_t b = 0; b < mask.size(); ++b) mask[b] = mask[b] || branch[b];
  return true;
}

// Returns the bodies that move with the first link of a finger.
std::vector<bool> Linkage(const mjModel* m, int hand, int first_link, int other_finger) {
  std::vector<bool> mask = SubtreeMask(m, first_link);
  for (bool grown = true; grown;) {
    grown = false;
    for (int e = 0; e < m->neq; ++e) {
      if (m->eq_type[e] != mjEQ_CONNECT && m->eq_type[e] != mjEQ_WELD) continue;
      const mjtObj kind = static_cast<mjtObj>(m->eq_objtype[e]);
      const int a = BodyOf(m, kind, m->eq_obj1id[e]), b = BodyOf(m, kind, m->eq_obj2id[e]);
      grown |= Grow(m, hand, other_finger, a, b, mask) || Grow(m, hand, other_finger, b, a, mask);
    }
  }
  return mask;
}

int FarthestBody(const mjModel* m, const mjData* d, int hand, const std::vector<bool>& linkage,
                 int otherwise) {
  double most = -1;
  int farthest = otherwise;
  for (int g = 0; g < m->ngeom; ++g) {
    if (!linkage[m->geom_bodyid[g]] || !Collides(m, g)) continue;
    const double distance = mju_dist3(d->geom_xpos + 3 * g, d->xpos + 3 * hand);
    if (distance <= most) continue;
    most = distance;
    farthest = m->geom_bodyid[g];
  }
  return farthest;
}

// Returns the geoms of the branch that leads from the hand to the finger; those of the hand alone
// if it is the finger itself.
std::vector<int> SideOf(const mjModel* m, int hand, int body) {
  int branch = body;
  while (branch != hand && m->body_parentid[branch] != hand) branch = m->body_parentid[branch];
  std::vector<int> geoms;
  for (int g = 0; g < m->ngeom; ++g) {
    int b = m->geom_bodyid[g];
    while (branch != hand && b > branch) b = m->body_parentid[b];
    if (b == branch) geoms.push_back(g);
  }
  return geoms;
}

// Returns the distance from a hinge's axis in metres.
double FromAxis(const mjData* d, int joint, const mjtNum* point) {
  mjtNum arm[3], across[3];
  mju_sub3(arm, point, d->xanchor + 3 * joint);
  mju_cross(across, d->xaxis + 3 * joint, arm);
  return mju_norm3(across);
}

}  // namespace

FingerPair MakeFingers(const mjModel* m, ElementId first, ElementId second,
                       const std::string& place) {
  return MakeFingers(m, std::array{first, second}, place);
}

FingerPair MakeFingers(const mjModel* m, std::span<const ElementId> elements,
                       const std::string& place) {
  std::vector<Finger> fingers;
  for (const ElementId& element : elements) fingers.push_back(MakeFinger(m, element));
  FingerPair pair{.hand = fingers[0].body, .fingers = {}};
  for (size_t i = 1; i < fingers.size(); ++i) {
    pair.hand = CommonAncestor(m, pair.hand, fingers[i].body);
    if (m->body_weldid[fingers[0].body] != m->body_weldid[fingers[i].body]) continue;
    throw ArgumentError(fmt::format(
        "{}: the fingers {} and {} are parts of one rigid body, so nothing moves between them; "
        "name one element of each finger",
        place, Describe(m, elements[0].kind, elements[0].id),
        Describe(m, elements[i].kind, elements[i].id)));
  }
  for (Finger& finger : fingers) finger.side = SideOf(m, pair.hand, finger.body);
  for (size_t i = 2; i < fingers.size(); ++i) {
    const auto add = [](std::vector<int>& to, const std::vector<int>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    add(fingers[1].sites, fingers[i].sites);
    add(fingers[1].geoms, fingers[i].geoms);
    add(fingers[1].side, fingers[i].side);
  }
  pair.fingers = {fingers[0], fingers[1]};
  return pair;
}

std::array<int, 2> FingertipBodies(const mjModel* m, int first, int second) {
  const int hand = CommonAncestor(m, first, second);
  if (hand == first || hand == second) return {first, second};
  const DataPtr data = MakeData(m);
  Guarded("finding the fingers", data.get(), [&] { mj_kinematics(m, data.get()); });
  return {FarthestBody(m, data.get(), hand, Linkage(m, hand, first, second), first),
          FarthestBody(m, data.get(), hand, Linkage(m, hand, second, first), second)};
}

std::optional<Jaw> FindJaw(const mjModel* m, const FingerPair& pair) {
  if (!pair.fingers[0].is_body && !pair.fingers[1].is_body) return std::nullopt;
  for (const int i : {0, 1}) {
    if (m->body_weldid[pair.fingers[1 - i].body] != m->body_weldid[pair.hand]) continue;
    std::vector<int> joints;
    for (int b = pair.fingers[i].body; b != pair.hand; b = m->body_parentid[b]) {
      for (int k = 0; k < m->body_jntnum[b]; ++k) joints.push_back(m->body_jntadr[b] + k);
    }
    if (joints.size() == 1 && m->jnt_type[joints[0]] == mjJNT_HINGE) return Jaw{i, joints[0]};
  }
  return std::nullopt;
}

bool IsMeasuredAtItsHinge(const mjModel* m, std::span<const double> qpos, const FingerPair& pair,
                          const Jaw& jaw) {
  const Finger &moving = pair.fingers[jaw.index], &fixed = pair.fingers[1 - jaw.index];
  const DataPtr data = MakeData(m);
  mjData* d = data.get();
  std::copy(qpos.begin(), qpos.end(), d->qpos);
  mjtNum& angle = d->qpos[m->jnt_qposadr[jaw.joint]];
  const double from = m->jnt_limited[jaw.joint] ? m->jnt_range[2 * jaw.joint] : angle;
  const double to = m->jnt_limited[jaw.joint] ? m->jnt_range[2 * jaw.joint + 1] : angle;
  double widest = -1, lever = 0;
  for (int i = 0; i <= kLooksAtAJaw; ++i) {
    angle = from + (to - from) * i / kLooksAtAJaw;
    Guarded("finding where a jaw is measured", d, [&] { mj_kinematics(m, d); });
    const NearestPoints nearest = NearestOf(m, d, moving, fixed);
    if (nearest.distance <= widest) continue;
    widest = nearest.distance;
    lever = FromAxis(d, jaw.joint, nearest.first);
  }
  double length = 0;
  for (const int g : moving.geoms)
    length = std::max(length, FromAxis(d, jaw.joint, d->geom_xpos + 3 * g) + m->geom_rbound[g]);
  return lever < kNearHinge * length;
}

std::string HowToNameTips(const CompiledScene& scene, const RobotRecord& robot,
                          const FingerPair& pair, const Jaw& jaw) {
  const auto full_name = [&](int finger) {
    return ElementName(scene.model(), mjOBJ_BODY, pair.fingers[static_cast<size_t>(finger)].body);
  };
  const auto name = [&](int finger) {
    const std::string full = full_name(finger);
    return full.starts_with(robot.prefix) ? full.substr(robot.prefix.size()) : full;
  };
  return fmt::format(
      "'{}' turns about a hinge in '{}', and the two are nearest at the hinge, however far their "
      "tips are apart: name the tips of both as `fingers`, geoms or sites ({})",
      name(jaw.index), name(1 - jaw.index),
      HowToAddSite(scene, robot, full_name(jaw.index), "tip", "[...]").text);
}

NearestPoints NearestOf(const mjModel* m, mjData* d, const Finger& a, const Finger& b) {
  NearestPoints nearest;
  Guarded("distance of the fingers", d, [&] {
    for (const int g : a.geoms) {
      for (const int h : b.geoms) {
        mjtNum points[6];
        const double distance = mj_geomDistance(m, d, g, h, nearest.distance, points);
        if (distance >= nearest.distance) continue;
        nearest.distance = distance;
        std::copy_n(points, 3, nearest.first);
        std::copy_n(points + 3, 3, nearest.second);
      }
    }
  });
  return nearest;
}

double FingerDistance(const mjModel* m, mjData* d, const Finger& a, const Finger& b) {
  if (a.sites.empty() || b.sites.empty()) return std::max(0.0, NearestOf(m, d, a, b).distance);
  double least = std::numeric_limits<double>::infinity();
  for (const int i : a.sites) {
    for (const int k : b.sites)
      least = std::min<double>(least, mju_dist3(d->site_xpos + 3 * i, d->site_xpos + 3 * k));
  }
  return least;
}

}  // namespace robocell::internal
