#include "robocell/scenes/joint_opening.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/landmarks.h"

namespace robocell {
namespace {

bool Opens(const mjModel* m, int joint) {
  return m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
}

// Returns the joint of that name, or the only one of an object or body.
int FindJoint(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  const std::string place = "scene '" + scene.name() + "'";
  if (const int joint = FindId(m, mjOBJ_JOINT, name); joint >= 0 && Opens(m, joint)) return joint;
  const int body = internal::FindObjectOrBody(scene, name);
  std::vector<int> joints;
  std::vector<std::string> all, own;
  for (int j = 0; j < m->njnt; ++j) {
    if (!Opens(m, j)) continue;
    all.push_back(ElementName(m, mjOBJ_JOINT, j));
    if (body < 0 || !internal::IsInSubtree(m, m->jnt_bodyid[j], body)) continue;
    joints.push_back(j);
    own.push_back(all.back());
  }
  if (body < 0) throw NotFoundError(NoSuchName(place, "joint, object or body", name, all));
  if (joints.size() == 1) return joints.front();
  throw ArgumentError(fmt::format(
      "{}: '{}' has {}, so that it is not known what opens; {}", place, name,
      joints.empty() ? "no hinge or slide" : Counted(static_cast<int64_t>(joints.size()), "joint"),
      joints.empty() ? "name an object with a door, a drawer or a button"
                     : "name one of them: " + ListNames(own)));
}

}  // namespace

JointOpening JointOpening::Of(const Scene& scene, const std::string& name) {
  const mjModel* m = scene.model();
  const int joint = FindJoint(scene, name);
  const std::string full = ElementName(m, mjOBJ_JOINT, joint);
  const double low = m->jnt_range[2 * joint], high = m->jnt_range[2 * joint + 1];
  if (!m->jnt_limited[joint] || !(low < high)) {
    throw ArgumentError(fmt::format(
        "scene '{}': joint '{}' has no range, so that no share of it is open; give it a `range` "
        "in its model",
        scene.name(), full));
  }
  const double closed = std::clamp(m->qpos0[m->jnt_qposadr[joint]], low, high);
  return {scene.inner(), full, closed, high - closed >= closed - low ? high : low};
}

void JointOpening::Put(double share) {
  const mjModel* m = scene_.model();
  const int joint = joint_id();
  scene_.data()->qpos[m->jnt_qposadr[joint]] = PositionAt(share);
  scene_.data()->qvel[m->jnt_dofadr[joint]] = 0;
}

int JointOpening::joint_id() const {
  return RequireId(scene_.model(), mjOBJ_JOINT, joint_, "scene '" + scene_.name() + "'");
}

int JointOpening::body_id() const { return scene_.model()->jnt_bodyid[joint_id()]; }

}  // namespace robocell
