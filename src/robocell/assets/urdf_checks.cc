#include "robocell/assets/urdf_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <Eigen/Eigenvalues>

#include "robocell/assets/urdf.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

template <class Elements>
std::vector<std::string> UrdfNames(const Elements& elements) {
  std::vector<std::string> names;
  for (const auto& element : elements) names.push_back(element.name);
  return names;
}

template <class Elements>
void CheckRepeated(const Elements& elements, const char* kind, UrdfProblems& problems) {
  std::map<std::string, int> lines;
  for (const auto& element : elements) {
    const auto [it, is_new] = lines.emplace(element.name, element.line);
    if (!is_new)
      problems.Add(element.line, fmt::format("{0} '{1}' is defined twice, first in line {2}. Give "
                                             "one of them another name, or remove it",
                                             kind, element.name, it->second));
  }
}

void CheckLinksExist(const Urdf& urdf, UrdfProblems& problems) {
  std::map<std::string, const UrdfJoint*> parents;
  for (const UrdfJoint& joint : urdf.joints) {
    for (const std::string& link : {joint.parent, joint.child}) {
      if (link.empty() || urdf.link(link)) continue;
      problems.Add(
          joint.line,
          NoSuchName(fmt::format("joint '{}'", joint.name), "link", link, UrdfNames(urdf.links)) +
              ". Correct the name, or add the link: <link name=\"" + link + "\"/>");
    }
    const auto [it, is_new] = parents.emplace(joint.child, &joint);
    if (!is_new)
      problems.Add(
          joint.line,
          fmt::format("link '{}' hangs on two joints, '{}' and '{}', and a URDF is a tree. "
                      "Remove one of them",
                      joint.child, it->second->name, joint.name));
  }
}

void CheckRoot(Urdf& urdf, UrdfProblems& problems) {
  std::vector<std::string> roots;
  for (const UrdfLink& link : urdf.links) {
    if (!urdf.parent_joint(link.name)) roots.push_back(link.name);
  }
  if (urdf.links.empty()) {
    problems.Add(0, "it has no <link>. Give the URDF of a robot");
  } else if (roots.empty()) {
    problems.Add(0,
                 "its joints form a circle: no link is without a parent. Remove the joint that "
                 "closes it");
  } else if (roots.size() > 1) {
    problems.Add(urdf.link(roots[1])->line,
                 fmt::format("it has {} links without a parent: {}. Join them with a joint: <joint "
                             "name=\"to_{}\" type=\"fixed\"><parent link=\"{}\"/><child "
                             "link=\"{}\"/></joint>",
                             roots.size(), ListNames(roots), roots[1], roots[0], roots[1]));
  } else {
    urdf.root = roots[0];
  }
}

// Links that a circle of joints connects to each other have parents, and are not below the root.
void CheckReached(const Urdf& urdf, UrdfProblems& problems) {
  std::set<std::string> reached = {urdf.root};
  for (bool grows = true; grows;) {
    grows = false;
    for (const UrdfJoint& joint : urdf.joints)
      grows |= reached.contains(joint.parent) && reached.insert(joint.child).second;
  }
  for (const UrdfLink& link : urdf.links) {
    if (reached.contains(link.name)) continue;
    problems.Add(link.line, fmt::format("link '{}' is in a circle of joints. Remove the joint that "
                                        "closes it",
                                        link.name));
    return;
  }
}

int ChildrenOf(const Urdf& urdf, const std::string& link) {
  return static_cast<int>(
      std::count_if(urdf.joints.begin(), urdf.joints.end(),
                    [&](const UrdfJoint& joint) { return joint.parent == link; }));
}

void CheckFloating(const Urdf& urdf, UrdfProblems& problems) {
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type != UrdfJointType::kFloating) continue;
    const UrdfLink& parent = *urdf.link(joint.parent);
    if (parent.name == urdf.root && parent.is_bare() && ChildrenOf(urdf, parent.name) == 1)
      continue;
    problems.Add(joint.line,
                 fmt::format("joint '{}': type=\"floating\" works below a root link without "
                             "<inertial>, <visual>, <collision> and other joints only, and '{}' is "
                             "not one. Write type=\"fixed\"",
                             joint.name, joint.parent));
  }
}

bool Moves(const UrdfJoint& joint) {
  return joint.type != UrdfJointType::kFixed && joint.type != UrdfJointType::kFloating;
}

void CheckMimic(const Urdf& urdf, UrdfProblems& problems) {
  for (const UrdfJoint& joint : urdf.joints) {
    if (!joint.mimic) continue;
    const std::string place = fmt::format("joint '{}'", joint.name);
    const UrdfJoint* leader = urdf.joint(joint.mimic->joint);
    if (!leader || !Moves(*leader)) {
      std::vector<std::string> names;
      for (const UrdfJoint& each : urdf.joints) {
        if (Moves(each) && !each.mimic) names.push_back(each.name);
      }
      problems.Add(joint.mimic->line,
                   leader
                       ? fmt::format("{}: it mimics the fixed joint '{}'. Remove the <mimic>, or "
                                     "name a joint that moves: {}",
                                     place, leader->name, ListNames(names))
                       : NoSuchName(place + ": mimic", "joint", joint.mimic->joint, names) +
                             ". Correct the name, or remove the <mimic>");
      continue;
    }
    std::vector<std::string> path = {joint.name};
    const UrdfJoint* at = leader;
    while (at && std::find(path.begin(), path.end(), at->name) == path.end()) {
      path.push_back(at->name);
      at = at->mimic ? urdf.joint(at->mimic->joint) : nullptr;
    }
    // Reported once, at the joint of the circle that is first in the file.
    if (!at || at->name != joint.name) continue;
    const bool first = std::all_of(path.begin(), path.end(), [&](const std::string& name) {
      return urdf.joint(name) >= &joint;
    });
    if (first)
      problems.Add(joint.mimic->line,
                   fmt::format("the mimic joints {} follow each other in a circle, so that none of "
                               "them can be driven. Remove the <mimic> of one of them",
                               ListNames(path)));
  }
}

bool HasInertia(const UrdfLink& link) {
  return link.has_mass() &&
         std::any_of(link.inertial->inertia.begin(), link.inertial->inertia.end(),
                     [](double value) { return value != 0; });
}

// Adds a problem for a moving link that, with all that is fixed to it, has mass but no inertia.
void CheckTurns(const Urdf& urdf, const UrdfLink& link, UrdfProblems& problems) {
  const UrdfLink* heavy = nullptr;
  for (const UrdfLink* each : urdf.RigidWith(link)) {
    if (HasInertia(*each)) return;
    if (!heavy && each->has_mass()) heavy = each;
  }
  const double moment = heavy->inertial->mass * 1e-3;
  problems.Add(heavy->inertial->line,
               fmt::format("link '{0}': {1:g} kg without inertia. Give it the link's; that of a "
                           "ball of this mass, 10 cm across: <inertia ixx=\"{2:g}\" ixy=\"0\" "
                           "ixz=\"0\" iyy=\"{2:g}\" iyz=\"0\" izz=\"{2:g}\"/>",
                           heavy->name, heavy->inertial->mass, moment));
}

// The engine needs mass on everything that moves; without <inertial> it takes the collision
// geometry for water.
void CheckMasses(Urdf& urdf, UrdfProblems& problems) {
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type == UrdfJointType::kFixed) continue;
    const UrdfLink& link = *urdf.link(joint.child);
    if (urdf.IsWeighed(link)) {
      CheckTurns(urdf, link, problems);
      continue;
    }
    const std::vector<const UrdfLink*> rigid = urdf.RigidWith(link);
    const bool has_shape = std::any_of(rigid.begin(), rigid.end(), [](const UrdfLink* each) {
      return std::any_of(each->geometry.begin(), each->geometry.end(),
                         [](const UrdfGeometry& geometry) { return geometry.collision; });
    });
    if (!has_shape) {
      problems.Add(link.line,
                   fmt::format("link '{}' moves with joint '{}' and has no mass. Add it to the "
                               "link: <inertial><mass value=\"0.1\"/><inertia ixx=\"0.0001\" "
                               "ixy=\"0\" ixz=\"0\" iyy=\"0.0001\" iyz=\"0\" izz=\"0.0001\"/>"
                               "</inertial>",
                               link.name, joint.name));
      continue;
    }
    urdf.notes.push_back(
        fmt::format("{}:{}: link '{}' has no <inertial>: its mass is that of its "
                    "collision geometry in water",
                    urdf.file.string(), link.line, link.name));
  }
}

void CheckInertias(const Urdf& urdf, UrdfProblems& problems) {
  constexpr double kTolerance = 1e-6;  // relative; files have rounded numbers
  const bool balances = urdf.mujoco.find("balanceinertia=\"true\"") != std::string::npos;
  for (const UrdfLink& link : urdf.links) {
    if (!link.inertial) continue;
    const UrdfInertial& given = *link.inertial;
    const auto& i = given.inertia;
    Eigen::Matrix3d inertia;
    inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
    const Eigen::Vector3d m =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly)
            .eigenvalues();
    const std::string moments =
        fmt::format("principal moments {:.3g}, {:.3g}, {:.3g} kg m2", m[0], m[1], m[2]);
    if (given.mass < 0 || m[0] < -kTolerance * m[2]) {
      problems.Add(given.line,
                   fmt::format("link '{}': no body has a negative mass or inertia ({:g} "
                               "kg, {}). Correct the numbers",
                               link.name, given.mass, moments));
    } else if (!balances && m[0] + m[1] < m[2] * (1 - kTolerance)) {
      problems.Add(given.line,
                   fmt::format("link '{}': no body has such an inertia ({}: the largest is more "
                               "than the sum of the others). Correct the numbers, or let MuJoCo do "
                               "it for all links: <mujoco><compiler balanceinertia=\"true\"/>"
                               "</mujoco> in the <robot> element",
                               link.name, moments));
    }
  }
}

}  // namespace

void UrdfProblems::Add(int line, const std::string& text) {
  texts_.push_back(line > 0 ? fmt::format("{}:{}: {}", file_.string(), line, text)
                            : fmt::format("{}: {}", file_.string(), text));
}

void UrdfProblems::Throw() const {
  if (texts_.empty()) return;
  std::string all;
  for (const std::string& text : texts_) all += (all.empty() ? "" : "\n") + text;
  throw SpecError(all);
}

void ValidateUrdf(Urdf& urdf, UrdfProblems& problems) {
  CheckRepeated(urdf.links, "link", problems);
  CheckRepeated(urdf.joints, "joint", problems);
  CheckLinksExist(urdf, problems);
  if (!problems.empty()) return;
  CheckRoot(urdf, problems);
  if (!problems.empty()) return;
  CheckReached(urdf, problems);
  if (!problems.empty()) return;
  CheckFloating(urdf, problems);
  CheckMimic(urdf, problems);
  CheckMasses(urdf, problems);
  CheckInertias(urdf, problems);
}

}  // namespace robocell::internal
