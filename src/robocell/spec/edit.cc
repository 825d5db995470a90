#include "robocell/spec/edit.h"

#include <algorithm>
#include <utility>

#include "robocell/base/suggestions.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

// Returns the attributes that a kind of element can have.
std::vector<std::string> AttributesOf(ElementKind kind) {
  switch (kind) {
    case ElementKind::kBody:
      return {"name", "pos", "quat", "euler", "xyaxes", "mass"};
    case ElementKind::kSite:
      return {"name", "pos", "quat", "euler", "xyaxes", "size", "rgba"};
    case ElementKind::kJoint:
      return {"name", "pos", "range", "damping", "armature", "frictionloss"};
    case ElementKind::kGeom:
      return {"name", "pos",  "quat", "euler",    "xyaxes",
              "size", "rgba", "mass", "friction", "condim"};
    case ElementKind::kCamera:
      return {"name", "pos", "quat", "euler", "xyaxes", "fovy"};
    case ElementKind::kActuator:
      return {"name", "ctrlrange", "forcerange", "kp", "kv"};
    case ElementKind::kSensor:
      return {"type"};
    default:
      return {};
  }
}

bool IsTarget(std::string_view field) {
  static const std::vector<std::string> kTargets = {
      "body",     "site",     "joint",      "geom",       "camera",
      "actuator", "add_site", "add_camera", "add_sensor", "delete"};
  return std::find(kTargets.begin(), kTargets.end(), field) != kTargets.end();
}

// `{geom: {body: finger}}` reads as a reference to a body; the intended one needs an index.
void ValidateTargetKind(const std::optional<ElementRef>& ref, ElementKind kind,
                        std::string_view field, Problems& problems) {
  if (!ref || !ref->kind || *ref->kind == kind) return;
  problems.AddAt(field, "is given a " + Describe(*ref) + "; write the " + std::string(field) +
                            "'s name, or {body: name, index: 0} if it has none");
}

// An actuator is identified by what it acts on; it belongs to no body.
void ValidateActuator(const std::optional<ElementRef>& ref, Problems& problems) {
  using enum ElementKind;
  if (!ref) return;
  const bool acts_on = ref->kind == kJoint || ref->kind == kTendon || ref->kind == kSite ||
                       ref->kind == kBody || ref->kind == kActuator;
  if (ref->body.empty() && (!ref->kind || acts_on)) return;
  problems.AddAt("actuator", "is given " + Describe(*ref) +
                                 "; write the actuator's name, or {joint: name}, the joint that it "
                                 "acts on (likewise tendon, site, body)");
}

std::vector<std::string> SetFields(const Edit& edit, bool targets) {
  std::vector<std::string> set;
  ForEachField(edit, [&](const char* name, const auto& value, const char*, Bound) {
    if (value.has_value() && IsTarget(name) == targets) set.emplace_back(name);
  });
  return set;
}

std::string Join(const std::vector<std::string>& names) { return ListNames(names, 40); }

}  // namespace

ElementKind Edit::kind() const {
  if (add_sensor) return ElementKind::kSensor;
  if (add_site) return ElementKind::kSite;
  if (add_camera) return ElementKind::kCamera;
  if (site) return ElementKind::kSite;
  if (joint) return ElementKind::kJoint;
  if (geom) return ElementKind::kGeom;
  if (camera) return ElementKind::kCamera;
  if (actuator) return ElementKind::kActuator;
  return ElementKind::kBody;
}

std::string Edit::Label() const {
  const std::optional<std::string>& added = add_sensor ? add_sensor
                                            : add_site ? add_site
                                                       : add_camera;
  if (added) return LabelOf(std::string("edit that adds ") + ToString(kind()), *added);
  for (const auto& [ref, ref_kind] :
       {std::pair{&remove, ElementKind::kBody}, std::pair{&site, ElementKind::kSite},
        std::pair{&joint, ElementKind::kJoint}, std::pair{&geom, ElementKind::kGeom},
        std::pair{&camera, ElementKind::kCamera}, std::pair{&actuator, ElementKind::kActuator},
        std::pair{&body, ElementKind::kBody}}) {
    if (!*ref || (*ref)->empty()) continue;
    ElementRef named = **ref;
    if (!named.kind && ref != &remove) named.kind = ref_kind;
    return "edit of " + Describe(named);
  }
  return "";
}

void Edit::Validate(Problems& problems) const {
  ValidateFovy(fovy, problems);
  std::vector<std::string> targets = SetFields(*this, true);
  if (add_site || add_camera) {
    if (!body)
      problems.Add("says no `body` to add to; write for example {add_site: tool, body: flange}");
    std::erase(targets, "body");
  }
  if (add_sensor) {
    if (!site) problems.Add("an added sensor needs the `site` it measures at");
    if (!type)
      problems.Add(
          "an added sensor needs a `type`: force, torque, gyro, accelerometer, velocimeter");
    std::erase(targets, "site");
  }
  if (targets.size() != 1) {
    problems.Add(
        "an edit names exactly one element by body, site, joint, geom, camera, actuator, add_site, "
        "add_camera, "
        "add_sensor or delete; this one names " +
        (targets.empty() ? "none" : Join(targets)));
    return;
  }
  const std::vector<std::string> attributes = SetFields(*this, false);
  if (remove) {
    if (!remove->kind)
      problems.AddAt("delete",
                     "say what kind of element it is, for example {delete: {camera: view}}");
    if (!attributes.empty()) problems.Add("a deleted element cannot be given " + Join(attributes));
    return;
  }
  const std::vector<std::string> known = AttributesOf(kind());
  for (const std::string& attribute : attributes) {
    if (std::find(known.begin(), known.end(), attribute) == known.end()) {
      problems.AddAt(attribute, std::string("a ") + ToString(kind()) +
                                    " has no such attribute; it can be given " + Join(known));
    }
  }
  ValidateTargetKind(site, ElementKind::kSite, "site", problems);
  ValidateTargetKind(joint, ElementKind::kJoint, "joint", problems);
  ValidateTargetKind(geom, ElementKind::kGeom, "geom", problems);
  ValidateTargetKind(camera, ElementKind::kCamera, "camera", problems);
  ValidateActuator(actuator, problems);
  ValidateTargetKind(body, ElementKind::kBody, "body", problems);
  if (range) ValidateRange(*range, "range", problems);
  if (ctrlrange) ValidateRange(*ctrlrange, "ctrlrange", problems);
  if (forcerange) ValidateRange(*forcerange, "forcerange", problems);
  if (condim && *condim != 1 && *condim != 3 && *condim != 4 && *condim != 6) {
    problems.AddAt("condim", std::to_string(*condim) + " is not 1, 3, 4 or 6");
  }
  if (attributes.empty() && !add_site) problems.Add("changes nothing; it can set " + Join(known));
  if ((quat ? 1 : 0) + (euler ? 1 : 0) + (xyaxes ? 1 : 0) > 1)
    problems.Add("give only one of quat, euler and xyaxes");
  if (quat) ValidateUnitQuat(*quat, problems);
}

}  // namespace robocell
