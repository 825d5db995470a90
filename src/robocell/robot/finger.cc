#include "robocell/robot/finger.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell {
namespace {

constexpr double kFarthest = 1.0;  // metres; no gripper opens wider

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

// A body's own colliding geoms; those welded to it when it has none; any of them when none
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
      finger.site = element.id;
      finger.body = m->site_bodyid[element.id];
      break;
    default:
      finger.body = element.id;
  }
  finger.geoms = MeasuredGeoms(m, finger.body);
  return finger;
}

// The geoms of the branch that leads from the hand to the finger; of the hand alone when it is the
// finger itself.
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

}  // namespace

FingerPair MakeFingers(const mjModel* m, ElementId first, ElementId second,
                       const std::string& place) {
  FingerPair pair{.fingers = {MakeFinger(m, first), MakeFinger(m, second)}};
  auto& [a, b] = pair.fingers;
  if (m->body_weldid[a.body] == m->body_weldid[b.body]) {
    throw ArgumentError(fmt::format(
        "{}: the fingers {} and {} are parts of one rigid body, so nothing moves between them; "
        "name one element of each finger",
        place, Describe(m, first.kind, first.id), Describe(m, second.kind, second.id)));
  }
  pair.hand = CommonAncestor(m, a.body, b.body);
  for (Finger& finger : pair.fingers) finger.side = SideOf(m, pair.hand, finger.body);
  return pair;
}

double FingerDistance(const mjModel* m, mjData* d, const Finger& a, const Finger& b) {
  if (a.site >= 0 && b.site >= 0) {
    return mju_dist3(d->site_xpos + 3 * a.site, d->site_xpos + 3 * b.site);
  }
  double least = kFarthest;
  Guarded("distance of the fingers", d, [&] {
    for (const int g : a.geoms) {
      for (const int h : b.geoms) {
        least = std::min<double>(least, mj_geomDistance(m, d, g, h, least, nullptr));
      }
    }
  });
  return std::max(0.0, least);
}

}  // namespace robocell
