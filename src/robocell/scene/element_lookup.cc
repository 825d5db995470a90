#include "robocell/scene/element_lookup.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

std::string Place(const RobotRecord& robot) { return "robot '" + robot.name + "'"; }

// Returns true if an element belongs to the robot: it has its prefix and, if it sits on a body,
// that body belongs to the robot or is mounted on it.
bool Belongs(const mjModel* model, const RobotRecord& robot, mjtObj kind, int id) {
  const std::string name = ElementName(model, kind, id);
  if (name.size() <= robot.prefix.size() || name.rfind(robot.prefix, 0) != 0) return false;
  const int body = BodyOf(model, kind, id);
  return body < 0 || IsInSubtree(model, body, FindId(model, mjOBJ_BODY, robot.top_body));
}

// Returns -1 if the robot has no element of that name.
int IdOf(const mjModel* model, const RobotRecord& robot, mjtObj kind, const std::string& name) {
  const int id = name.empty() ? -1 : FindId(model, kind, robot.prefix + name);
  return id >= 0 && Belongs(model, robot, kind, id) ? id : -1;
}

// Returns the body whose elements of this kind are counted: for a body, its parent.
int HolderOf(const mjModel* model, mjtObj kind, int id) {
  if (kind != mjOBJ_BODY) return BodyOf(model, kind, id);
  return id == 0 ? -1 : model->body_parentid[id];
}

ElementId FindByIndex(const mjModel* model, const RobotRecord& robot, const ElementRef& ref,
                      mjtObj kind) {
  const int body = FindElement(model, robot, mjOBJ_BODY, ref.body);
  int seen = 0;
  for (int id = 0; id < ElementCount(model, kind); ++id) {
    if (HolderOf(model, kind, id) == body && seen++ == ref.index) return {kind, id};
  }
  throw NotFoundError(
      fmt::format("{}: body '{}' has {} {}(s), so there is none with index {} (they count from 0)",
                  Place(robot), ref.body, seen, KindName(kind), ref.index));
}

// Advice for geoms and cameras; other elements of a robot's file have labels.
std::string HowToReferToUnnamed(const mjModel* model, const RobotRecord& robot, mjtObj kind) {
  const int top = FindId(model, mjOBJ_BODY, robot.top_body);
  size_t count = 0;
  int first = -1;
  for (int id = 0; id < ElementCount(model, kind); ++id) {
    const int body = BodyOf(model, kind, id);
    if (body < 0 || !ElementName(model, kind, id).empty() || !IsInSubtree(model, body, top))
      continue;
    if (count++ == 0) first = body;
  }
  if (count == 0) return "";
  return UnnamedHint(KindName(kind), count,
                     ElementName(model, mjOBJ_BODY, first).substr(robot.prefix.size()));
}

// Returns the element that an edit names; null for an edit that adds or deletes.
const ElementRef* NamedBy(const Edit& edit, mjtObj kind) {
  const auto ref = [](const std::optional<ElementRef>& target) {
    return target ? &*target : nullptr;
  };
  if (edit.add_site || edit.add_camera || edit.add_sensor || edit.remove) return nullptr;
  switch (kind) {
    case mjOBJ_BODY:
      return ref(edit.body);
    case mjOBJ_JOINT:
      return ref(edit.joint);
    case mjOBJ_SITE:
      return ref(edit.site);
    case mjOBJ_ACTUATOR:
      return ref(edit.actuator);
    default:
      return nullptr;
  }
}

// Returns true if `label` stood for the element of an edit before it had a name.
bool IsLabelOf(const ElementRef& ref, mjtObj kind, const std::string& label) {
  const bool of_target = kind == mjOBJ_ACTUATOR && ref.kind && *ref.kind != ElementKind::kActuator;
  if (of_target) return label.starts_with(ref.name + ":actuator");
  if (ref.body.empty()) return label == ref.name;
  return label == fmt::format("{}:{}{}", ref.body, KindName(kind), ref.index);
}

// Returns, for a label that an edit has replaced, " It is called 'joint2' now: edits[0] gives it
// that name".
std::string NamedSince(const RobotRecord& robot, mjtObj kind, const std::string& label) {
  int index = 0;
  for (const Edit& edit : robot.config.edits) {
    const ElementRef* ref = edit.name ? NamedBy(edit, kind) : nullptr;
    if (ref && IsLabelOf(*ref, kind, label))
      return fmt::format(" It is called '{}' now: edits[{}] gives it that name", *edit.name, index);
    ++index;
  }
  return "";
}

// Joins the kinds: "site or body".
std::string Words(std::initializer_list<mjtObj> kinds) {
  std::string words;
  for (const mjtObj kind : kinds)
    words += (words.empty() ? "" : " or ") + std::string(KindName(kind));
  return words;
}

}  // namespace

std::string UnnamedHint(std::string_view kind, size_t count, const std::string& body) {
  return fmt::format(" {} {} no name; write for example {{{}: {{body: '{}', index: 0}}}}", count,
                     count == 1 ? "has" : "have", kind, body);
}

mjtObj EngineKind(ElementKind kind) {
  switch (kind) {
    case ElementKind::kBody:
      return mjOBJ_BODY;
    case ElementKind::kSite:
      return mjOBJ_SITE;
    case ElementKind::kGeom:
      return mjOBJ_GEOM;
    case ElementKind::kJoint:
      return mjOBJ_JOINT;
    case ElementKind::kCamera:
      return mjOBJ_CAMERA;
    case ElementKind::kActuator:
      return mjOBJ_ACTUATOR;
    case ElementKind::kSensor:
      return mjOBJ_SENSOR;
    case ElementKind::kLight:
      return mjOBJ_LIGHT;
    case ElementKind::kTendon:
      return mjOBJ_TENDON;
    case ElementKind::kEquality:
      return mjOBJ_EQUALITY;
    case ElementKind::kKey:
      return mjOBJ_KEY;
  }
  return mjOBJ_UNKNOWN;
}

std::vector<std::string> RobotElementNames(const mjModel* model, const RobotRecord& robot,
                                           mjtObj kind) {
  std::vector<std::string> names;
  for (int id = 0; id < ElementCount(model, kind); ++id) {
    if (!Belongs(model, robot, kind, id)) continue;
    names.push_back(ElementName(model, kind, id).substr(robot.prefix.size()));
  }
  return names;
}

int FindElement(const mjModel* model, const RobotRecord& robot, mjtObj kind,
                const std::string& name) {
  const int id = IdOf(model, robot, kind, name);
  if (id >= 0) return id;
  throw NotFoundError(
      NoSuchName(Place(robot), KindName(kind), name, RobotElementNames(model, robot, kind)) +
      NamedSince(robot, kind, name) + HowToReferToUnnamed(model, robot, kind));
}

ElementId FindElement(const mjModel* model, const RobotRecord& robot, const ElementRef& ref,
                      std::initializer_list<mjtObj> kinds) {
  if (!ref.kind && !ref.body.empty()) {
    throw NotFoundError(fmt::format(
        "{}: element {} of body '{}': of which kind? Write for example {{{}: {{body: "
        "{}, index: {}}}}}",
        Place(robot), ref.index, ref.body, KindName(*kinds.begin()), ref.body, ref.index));
  }
  if (ref.kind) {
    const mjtObj kind = EngineKind(*ref.kind);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      throw NotFoundError(fmt::format("{}: {} is given; a {} is wanted here", Place(robot),
                                      Describe(ref), Words(kinds)));
    }
    if (!ref.body.empty()) return FindByIndex(model, robot, ref, kind);
    return {kind, FindElement(model, robot, kind, ref.name)};
  }
  for (const mjtObj kind : kinds) {
    if (const int id = IdOf(model, robot, kind, ref.name); id >= 0) return {kind, id};
  }
  std::vector<std::string> names;
  for (const mjtObj kind : kinds) {
    for (std::string& name : RobotElementNames(model, robot, kind))
      names.push_back(std::move(name));
  }
  std::string how;
  for (const mjtObj kind : kinds)
    how += NamedSince(robot, kind, ref.name) + HowToReferToUnnamed(model, robot, kind);
  throw NotFoundError(NoSuchName(Place(robot), Words(kinds), ref.name, names) + how);
}

}  // namespace robocell::internal
