// A part's own keyframe `home`, read before the part's keys are dropped (a key that is attached
// keeps the other parts at their reference, and blocks deleting joints).
#include <mujoco/mujoco.h>

#include "robocell/mujoco/engine_exception.h"
#include "robocell/scene/part.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

int PositionCount(const mjsJoint* joint) {
  switch (joint->type) {
    case mjJNT_FREE:
      return 7;
    case mjJNT_BALL:
      return 4;
    default:
      return 1;
  }
}

// Joints in the order of qpos: bodies depth first, each with its own joints first.
void CollectJoints(mjsBody* body, std::vector<mjsElement*>& out) {
  for (mjsElement* joint : BodyElements(body, mjOBJ_JOINT)) out.push_back(joint);
  for (mjsElement* child : BodyElements(body, mjOBJ_BODY)) CollectJoints(mjs_asBody(child), out);
}

// Takes `count` numbers from `numbers` for `name` and moves on; unnamed elements are passed over.
class Splitter {
 public:
  explicit Splitter(const mjDoubleVec* numbers) { data_ = mjs_getDouble(numbers, &size_); }

  void Take(const std::string& name, int count, std::map<std::string, std::vector<double>>& out) {
    if (at_ + count <= size_ && !name.empty()) out[name].assign(data_ + at_, data_ + at_ + count);
    at_ += count;
  }

 private:
  const double* data_ = nullptr;
  int size_ = 0;
  int at_ = 0;
};

}  // namespace

void PartHome::Merge(const PartHome& other, const std::string& prefix) {
  for (const auto& [name, values] : other.qpos) qpos.emplace(prefix + name, values);
  for (const auto& [name, values] : other.ctrl) ctrl.emplace(prefix + name, values);
  for (const auto& [name, source] : other.sources) sources.emplace(prefix + name, source);
}

void PartHome::Rename(mjtObj kind, const std::string& from, const std::string& to) {
  const auto rename = [&](auto& map) {
    auto entry = map.extract(from);
    if (entry.empty()) return;
    entry.key() = to;
    map.insert(std::move(entry));
  };
  if (kind == mjOBJ_ACTUATOR) rename(ctrl);
  if (kind != mjOBJ_JOINT) return;
  rename(qpos);
  rename(sources);
  if (const auto source = sources.find(to); source != sources.end()) source->second.joint = to;
}

std::vector<JointPositions> PositionsInOrder(mjSpec* spec) {
  std::vector<mjsElement*> joints;
  CollectJoints(WorldBody(spec), joints);
  std::vector<JointPositions> out;
  for (mjsElement* joint : joints)
    out.push_back({SpecName(joint), PositionCount(mjs_asJoint(joint))});
  return out;
}

PartHome ReadHomeKey(mjSpec* spec, const std::string& place, const std::string& field,
                     const std::string& file) {
  PartHome home;
  mjsElement* element = FindSpecElement(spec, mjOBJ_KEY, "home");
  if (!element) return home;
  const mjsKey* key = mjs_asKey(element);
  Splitter qpos(key->qpos), ctrl(key->ctrl);
  for (const JointPositions& joint : PositionsInOrder(spec))
    qpos.Take(joint.name, joint.count, home.qpos);
  // Actuators with several inputs are told apart only after compiling; none of them is a servo
  // here.
  for (mjsElement* actuator : SpecElements(spec, mjOBJ_ACTUATOR))
    ctrl.Take(SpecName(actuator), 1, home.ctrl);
  for (const auto& [joint, values] : home.qpos) home.sources[joint] = {place, field, file, joint};
  return home;
}

void DropKeys(mjSpec* spec) {
  for (mjsElement* key : SpecElements(spec, mjOBJ_KEY)) {
    Tried("dropping a keyframe", [&] { mjs_delete(spec, key); });
  }
  spec->nkey = 0;
}

}  // namespace robocell
