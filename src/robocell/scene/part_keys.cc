#include "robocell/scene/part_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
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

int VelocityCount(int positions) { return positions == 1 ? 1 : positions - 1; }

// The number of values of each actuator in a key.
struct ActuatorSizes {
  std::vector<int> inputs, activations;
};

int Sum(const std::vector<int>& sizes) { return std::accumulate(sizes.begin(), sizes.end(), 0); }

ActuatorSizes UsualSizes(mjSpec* spec) {
  ActuatorSizes sizes;
  for (mjsElement* element : SpecElements(spec, mjOBJ_ACTUATOR)) {
    const mjsActuator* actuator = mjs_asActuator(element);
    sizes.inputs.push_back(1);
    sizes.activations.push_back(actuator->actdim >= 0 ? actuator->actdim
                                                      : actuator->dyntype != mjDYN_NONE);
  }
  return sizes;
}

// Returns sizes of the compiled part: some actuators have several inputs or activations. Unset if
// it does not compile.
std::optional<ActuatorSizes> CompiledSizes(mjSpec* spec) {
  std::vector<std::string> warnings;  // the scene reports them again
  try {
    const SpecPtr copy = CopySpec(spec);
    DropKeys(copy.get());
    const ModelPtr model = Compile(copy.get(), nullptr, "a model with keyframes", &warnings);
    return ActuatorSizes{{model->actuator_ctrlnum, model->actuator_ctrlnum + model->nactuator},
                         {model->actuator_actnum, model->actuator_actnum + model->nactuator}};
  } catch (const SpecError&) {  // compiling the scene reports it
    return std::nullopt;
  }
}

// Compiled only for the rare model that needs it, because meshes take time. Numbers with an unknown
// owner are ignored.
ActuatorSizes SizesOf(mjSpec* spec) {
  ActuatorSizes sizes = UsualSizes(spec);
  const auto fits = [](int given, const std::vector<int>& each) {
    return given == 0 || given == Sum(each);
  };
  for (mjsElement* element : SpecElements(spec, mjOBJ_KEY)) {
    int controls = 0, activations = 0;
    mjs_getDouble(mjs_asKey(element)->ctrl, &controls);
    mjs_getDouble(mjs_asKey(element)->act, &activations);
    if (controls < Sum(sizes.inputs)) controls = 0;  // the last ones are missing
    if (fits(controls, sizes.inputs) && fits(activations, sizes.activations)) continue;
    if (auto compiled = CompiledSizes(spec)) return *compiled;
    return {};
  }
  return sizes;
}

// Collects joints in the order of qpos: bodies depth first, each with its own joints first.
void CollectJoints(mjsBody* body, std::vector<mjsElement*>& out) {
  for (mjsElement* joint : BodyElements(body, mjOBJ_JOINT)) out.push_back(joint);
  for (mjsElement* child : BodyElements(body, mjOBJ_BODY)) CollectJoints(mjs_asBody(child), out);
}

void NameUnnamed(mjSpec* spec, const std::string& place) {
  const auto name = [&](mjsElement* element, size_t number) {
    if (!SpecName(element).empty()) return;
    std::string own = fmt::format("{}{}", KindName(element->elemtype), number);
    while (FindSpecElement(spec, element->elemtype, own)) own += "_";
    SetSpecName(element, own, place);
  };
  std::vector<mjsElement*> joints;
  CollectJoints(WorldBody(spec), joints);
  for (size_t i = 0; i < joints.size(); ++i) name(joints[i], i);
  const std::vector<mjsElement*> actuators = SpecElements(spec, mjOBJ_ACTUATOR);
  for (size_t i = 0; i < actuators.size(); ++i) name(actuators[i], i);
}

// Takes `count` numbers from `numbers` for `name` and moves on; skips unnamed elements.
class Splitter {
 public:
  explicit Splitter(const mjDoubleVec* numbers) { data_ = mjs_getDouble(numbers, &size_); }

  void Take(const std::string& name, int count, PartKey::Values& out) {
    if (count > 0 && at_ + count <= size_ && !name.empty())
      out[name].assign(data_ + at_, data_ + at_ + count);
    at_ += count;
  }

 private:
  const double* data_ = nullptr;
  int size_ = 0;
  int at_ = 0;
};

// Reads the pose of a mocap body relative to the file's pose, so that it holds wherever the part is
// placed. The key has both numbers of all mocap bodies, or the file's where it leaves them out.
void TakeMocap(mjSpec* spec, const mjsKey* key, PartKey& out) {
  int positions = 0, rotations = 0, index = 0;
  const double* pos = mjs_getDouble(key->mpos, &positions);
  const double* quat = mjs_getDouble(key->mquat, &rotations);
  for (mjsElement* element : BodyElements(WorldBody(spec), mjOBJ_BODY)) {
    if (!mjs_asBody(element)->mocap) continue;
    const int i = index++;
    const bool has_pos = 3 * (i + 1) <= positions, has_quat = 4 * (i + 1) <= rotations;
    const std::string name = SpecName(element);
    if (name.empty()) continue;
    const Pose authored = PoseInParent(element);
    double own_pos[3], own_quat[4];
    authored.ToWxyz(own_pos, own_quat);
    const Pose there = Pose::FromWxyz(has_pos ? pos + 3 * static_cast<size_t>(i) : own_pos,
                                      has_quat ? quat + 4 * static_cast<size_t>(i) : own_quat);
    out.mocap[name] = authored.inverse() * there;
  }
}

PartKey ReadKey(mjSpec* spec, const mjsKey* key, const ActuatorSizes& sizes,
                const PartKey::Source& source) {
  PartKey out;
  Splitter qpos(key->qpos), qvel(key->qvel), act(key->act), ctrl(key->ctrl);
  for (const JointPositions& joint : PositionsInOrder(spec)) {
    qpos.Take(joint.name, joint.count, out.qpos);
    qvel.Take(joint.name, VelocityCount(joint.count), out.qvel);
    out.joint_sources[joint.name] = source;
    out.joint_sources[joint.name].name = joint.name;
  }
  const std::vector<mjsElement*> actuators = SpecElements(spec, mjOBJ_ACTUATOR);
  for (size_t i = 0; i < actuators.size() && i < sizes.inputs.size(); ++i) {
    const std::string name = SpecName(actuators[i]);
    ctrl.Take(name, sizes.inputs[i], out.ctrl);
    act.Take(name, sizes.activations[i], out.act);
    out.actuator_sources[name] = source;
    out.actuator_sources[name].name = name;
  }
  TakeMocap(spec, key, out);
  return out;
}

constexpr size_t kFreePositions = 7;

// Returns a rotation without its heading, which is its twist about z.
Pose WithoutHeading(const Pose& pose) {
  const Quaternion& q = pose.quaternion();
  const double norm = std::hypot(q[2], q[3]);
  // Upside down there is no heading.
  const Quaternion heading =
      norm < 1e-9 ? Quaternion{0, 0, 0, 1} : Quaternion{0, 0, q[2] / norm, q[3] / norm};
  return Pose(Eigen::Vector3d::Zero(), heading).inverse() * Pose(Eigen::Vector3d::Zero(), q);
}

template <class Map>
void RenameKey(Map& map, const std::string& from, const std::string& to) {
  auto entry = map.extract(from);
  if (entry.empty()) return;
  entry.key() = to;
  map.insert(std::move(entry));
}

template <class Map>
void RenameSource(Map& sources, const std::string& from, const std::string& to) {
  RenameKey(sources, from, to);
  if (const auto source = sources.find(to); source != sources.end()) source->second.name = to;
}

template <class Map>
void MergeMap(Map& map, const Map& other, const std::string& prefix) {
  for (const auto& [name, value] : other) map.emplace(prefix + name, value);
}

}  // namespace

void PartKey::Merge(const PartKey& other, const std::string& prefix) {
  MergeMap(qpos, other.qpos, prefix);
  MergeMap(qvel, other.qvel, prefix);
  MergeMap(act, other.act, prefix);
  MergeMap(ctrl, other.ctrl, prefix);
  MergeMap(mocap, other.mocap, prefix);
  MergeMap(joint_sources, other.joint_sources, prefix);
  MergeMap(actuator_sources, other.actuator_sources, prefix);
}

void PartKey::Rename(mjtObj kind, const std::string& from, const std::string& to) {
  if (kind == mjOBJ_ACTUATOR) {
    RenameKey(ctrl, from, to);
    RenameKey(act, from, to);
    RenameSource(actuator_sources, from, to);
  } else if (kind == mjOBJ_JOINT) {
    RenameKey(qpos, from, to);
    RenameKey(qvel, from, to);
    RenameSource(joint_sources, from, to);
  } else if (kind == mjOBJ_BODY) {
    RenameKey(mocap, from, to);
  }
}

void PartKey::PlaceFree(const Pose& world, FreeKeys kept) {
  for (auto joint = qpos.begin(); joint != qpos.end();) {
    std::vector<double>& values = joint->second;
    if (values.size() != kFreePositions) {
      ++joint;
      continue;
    }
    const auto velocity = qvel.find(joint->first);
    if (kept == FreeKeys::kNone) {
      if (velocity != qvel.end()) qvel.erase(velocity);
      joint = qpos.erase(joint);
      continue;
    }
    const Pose key = Pose::FromWxyz(values.data(), values.data() + 3);
    Pose placed = key;
    if (kept == FreeKeys::kHeightAndTilt)
      placed = Pose({0, 0, key.translation().z()}, WithoutHeading(key).quaternion());
    placed = world * placed;
    placed.ToWxyz(values.data(), values.data() + 3);
    if (velocity != qvel.end()) {  // the engine gives the linear velocity in the world's frame
      const Eigen::Map<const Eigen::Vector3d> linear(velocity->second.data());
      const Eigen::Vector3d turned = placed.rotation() * key.rotation().transpose() * linear;
      std::copy_n(turned.data(), 3, velocity->second.begin());
    }
    ++joint;
  }
}

void PartKeys::PlaceFree(const Pose& world, FreeKeys kept) {
  home.PlaceFree(world, kept);
  for (auto& [name, key] : presets) key.PlaceFree(world, kept);
}

PartKey* PartKeys::Find(const std::string& name) {
  if (name == "home") return &home;
  const auto at = std::find_if(presets.begin(), presets.end(),
                               [&](const auto& preset) { return preset.first == name; });
  return at == presets.end() ? nullptr : &at->second;
}

void PartKeys::Remove(const std::string& name) {
  if (name == "home") home = {};
  std::erase_if(presets, [&](const auto& preset) { return preset.first == name; });
}

std::vector<std::string> PartKeys::PresetNames() const {
  std::vector<std::string> names;
  for (const auto& [name, key] : presets) names.push_back(name);
  return names;
}

void PartKeys::Rename(mjtObj kind, const std::string& from, const std::string& to) {
  home.Rename(kind, from, to);
  for (auto& [name, key] : presets) key.Rename(kind, from, to);
}

void PartKeys::Merge(const PartKeys& other, const std::string& prefix) {
  home.Merge(other.home, prefix);
  for (const auto& [name, key] : other.presets) {
    // A prefix may turn the name of a preset into `home`: that preset is home.
    if (PartKey* known = Find(prefix + name)) {
      known->Merge(key, prefix);
    } else {
      presets.emplace_back(prefix + name, PartKey{}).second.Merge(key, prefix);
    }
  }
}

std::map<std::string, std::string> PartKeys::Adopt(const PartKeys& other, const std::string& prefix,
                                                   const std::string& part) {
  home.Merge(other.home, prefix);
  std::map<std::string, std::string> renamed;
  for (const auto& [name, key] : other.presets) {
    std::string full = prefix + name;
    for (int number = 2; Find(full); ++number) full = fmt::format("{}{}_{}", prefix, name, number);
    if (full != prefix + name) renamed.emplace(name, full);
    PartKey& own = presets.emplace_back(full, PartKey{}).second;
    own.Merge(key, prefix);
    own.part = part;
    own.own_name = name;
  }
  return renamed;
}

std::vector<JointPositions> PositionsInOrder(mjSpec* spec) {
  std::vector<mjsElement*> joints;
  CollectJoints(WorldBody(spec), joints);
  std::vector<JointPositions> out;
  for (mjsElement* joint : joints)
    out.push_back({SpecName(joint), PositionCount(mjs_asJoint(joint))});
  return out;
}

PartKeys ReadKeys(mjSpec* spec, const std::string& place, const std::string& field,
                  const std::string& file) {
  PartKeys keys;
  if (!SpecElements(spec, mjOBJ_KEY).empty()) NameUnnamed(spec, place);
  const ActuatorSizes sizes = SizesOf(spec);
  int index = 0;
  for (mjsElement* element : SpecElements(spec, mjOBJ_KEY)) {
    std::string name = SpecName(element);
    if (name.empty()) name = fmt::format("key{}", index);
    ++index;
    PartKey key = ReadKey(spec, mjs_asKey(element), sizes, {place, field, file, name, ""});
    if (name == "home") {
      keys.home = std::move(key);
    } else if (!keys.Find(name)) {
      keys.presets.emplace_back(name, std::move(key));
    }
  }
  return keys;
}

void DropKeys(mjSpec* spec) {
  for (mjsElement* key : SpecElements(spec, mjOBJ_KEY)) {
    Tried("dropping a keyframe", [&] { mjs_delete(spec, key); });
  }
  spec->nkey = 0;
}

}  // namespace robocell::internal
