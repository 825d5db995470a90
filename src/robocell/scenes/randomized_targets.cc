#include "robocell/scenes/randomized_targets.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/name_pattern.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {

RandomizedTarget RandomizedTargets::Resolve(const std::string& name, int root) const {
  const mjModel* m = scene_.model();
  RandomizedTarget out{.name = name};
  const std::vector<bool> inside = SubtreeMask(m, root);
  for (int b = 1; b < m->nbody; ++b) {
    if (inside[b]) out.bodies.push_back(b);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (!inside[m->geom_bodyid[g]]) continue;
    out.geoms.push_back(g);
    if (m->geom_group[g] < kFirstHiddenGroup) out.shown.push_back(g);
  }
  for (int j = 0; j < m->njnt; ++j) {
    if (!inside[m->jnt_bodyid[j]]) continue;
    if (m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE)
      out.dofs.push_back(m->jnt_dofadr[j]);
  }
  for (int a = 0; a < m->nactuator; ++a) {
    const int body = BodyOfActuator(m, a);
    if (body > 0 && inside[body] && m->actuator_biastype[a] == mjBIAS_AFFINE)
      out.servos.push_back(a);
  }
  return out;
}

std::optional<RandomizedTarget> RandomizedTargets::ResolveElement(const std::string& name) const {
  const mjModel* m = scene_.model();
  if (const int body = FindId(m, mjOBJ_BODY, name); body > 0) return Resolve(name, body);
  const int geom = FindId(m, mjOBJ_GEOM, name);
  if (geom < 0) return std::nullopt;
  RandomizedTarget out{.name = name, .geoms = {geom}};
  if (m->geom_group[geom] < kFirstHiddenGroup) out.shown = {geom};
  return out;
}

// Finds the targets of the present model.
void RandomizedTargets::Bind() {
  if (generation_ == scene_.generation()) return;
  targets_.clear();
  const mjModel* m = scene_.model();
  const CompiledScene& compiled = *scene_.compiled();
  std::set<int> taken;  // bodies in the world that belong to objects and robots
  const auto add = [&](const std::string& name, const std::string& body) -> RandomizedTarget& {
    const int root = RequireId(m, mjOBJ_BODY, body, "scene '" + scene_.name() + "'");
    taken.insert(m->body_rootid[root]);
    return targets_.emplace_back(Resolve(name, root));
  };
  for (const ObjectRecord& object : compiled.objects()) {
    if (object.name == kStudio)
      taken.insert(FindId(m, mjOBJ_BODY, object.root_body));
    else
      add(object.name, object.root_body).is_object = true;
  }
  for (const RobotRecord& robot : compiled.robots()) {
    add(robot.name, robot.base_body).is_robot = true;
    if (robot.mocap_body) taken.insert(FindId(m, mjOBJ_BODY, *robot.mocap_body));
    if (const int target = FindId(m, mjOBJ_BODY, robot.base_target()); target > 0)
      taken.insert(target);
  }
  for (int b = 1; b < m->nbody; ++b) {
    const std::string name = ElementName(m, mjOBJ_BODY, b);
    if (m->body_parentid[b] == 0 && !taken.contains(b) && !name.empty())
      targets_.push_back(Resolve(name, b));
  }
  for (int g = 0; g < m->ngeom; ++g) {
    const std::string name = ElementName(m, mjOBJ_GEOM, g);
    if (m->geom_bodyid[g] == 0 && !name.empty()) targets_.push_back(*ResolveElement(name));
  }
  generation_ = scene_.generation();
}

std::vector<std::string> RandomizedTargets::names() {
  Bind();
  std::vector<std::string> all;
  for (const RandomizedTarget& each : targets_) all.push_back(each.name);
  return all;
}

std::vector<std::string> RandomizedTargets::Matching(const std::string& pattern) {
  Bind();
  std::vector<std::string> meant;
  for (const RandomizedTarget& each : targets_) {
    const bool is_meant = (pattern == "objects" && each.is_object) ||
                          (pattern == "robots" && each.is_robot) || FitsPattern(pattern, each.name);
    if (is_meant && std::ranges::find(meant, each.name) == meant.end()) meant.push_back(each.name);
  }
  if (meant.empty() && !IsNamePattern(pattern) && ResolveElement(pattern)) meant = {pattern};
  return meant;
}

bool RandomizedTargets::Has(const std::string& target) {
  Bind();
  return std::ranges::find(targets_, target, &RandomizedTarget::name) != targets_.end() ||
         ResolveElement(target);
}

void RandomizedTargets::RequireMatch(const std::string& pattern,
                                     const std::vector<std::string>& others,
                                     const std::string& place) {
  if (pattern == "objects" || pattern == "robots" || !Matching(pattern).empty()) return;
  if (std::ranges::any_of(others,
                          [&](const std::string& name) { return FitsPattern(pattern, name); }))
    return;
  std::vector<std::string> known = names();
  for (const std::string& name : others) {
    if (std::ranges::find(known, name) == known.end()) known.push_back(name);
  }
  known.insert(known.begin(), {"objects", "robots"});
  throw NotFoundError(NoSuchName(place, "target", pattern, known));
}

const RandomizedTarget& RandomizedTargets::At(const std::string& name, const std::string& place) {
  Bind();
  const auto known = std::ranges::find(targets_, name, &RandomizedTarget::name);
  if (known != targets_.end()) return *known;
  if (auto element = ResolveElement(name)) return targets_.emplace_back(*std::move(element));
  throw NotFoundError(NoSuchName(place, "target", name, names()));
}

}  // namespace robocell::internal
