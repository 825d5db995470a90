#include "robocell/scene/element_match.h"

#include <fmt/format.h>

#include <unordered_map>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

using Keys = std::vector<std::string>;

// Owners before what they own.
constexpr mjtObj kMatched[] = {mjOBJ_BODY,     mjOBJ_JOINT,  mjOBJ_GEOM,   mjOBJ_SITE,
                               mjOBJ_CAMERA,   mjOBJ_LIGHT,  mjOBJ_TENDON, mjOBJ_MATERIAL,
                               mjOBJ_ACTUATOR, mjOBJ_SENSOR, mjOBJ_PLUGIN, mjOBJ_EQUALITY,
                               mjOBJ_PAIR};

mjtObj WrapKind(int type) {
  return type == mjWRAP_JOINT ? mjOBJ_JOINT : type == mjWRAP_SITE ? mjOBJ_SITE : mjOBJ_GEOM;
}

// The first of a model's elements that refers to a plugin's instance.
int Referrer(const int* instances, int count, int plugin) {
  for (int i = 0; i < count; ++i) {
    if (instances[i] == plugin) return i;
  }
  return -1;
}

// Makes the keys by which elements of a model are recognised.
class KeyMaker {
 public:
  explicit KeyMaker(const mjModel* m) : m_(m) {
    for (const mjtObj kind : kMatched) AddKeys(kind);
  }
  const Keys& of(mjtObj kind) const { return keys_.at(kind); }

 private:
  void AddKeys(mjtObj kind) {
    Keys& keys = keys_[kind];
    std::unordered_map<std::string, int> unnamed;  // how many of an owner so far
    const int count = ElementCount(m_, kind);
    for (int id = 0; id < count; ++id) {
      const std::string name = ElementName(m_, kind, id);
      const std::string type = Type(kind, id);
      if (!name.empty()) {
        keys.push_back(fmt::format("'{}'{}", name, type));
        continue;
      }
      const std::string owner = type + " of " + Owner(kind, id);
      keys.push_back(fmt::format("{}{}", unnamed[owner]++, owner));
    }
  }

  std::string Key(int kind, int id) const {
    const auto keys = keys_.find(static_cast<mjtObj>(kind));
    if (keys != keys_.end() && id >= 0 && id < static_cast<int>(keys->second.size()))
      return keys->second[id];
    return ElementName(m_, static_cast<mjtObj>(kind), id);
  }

  std::string Type(mjtObj kind, int id) const {
    switch (kind) {
      case mjOBJ_BODY:
        return m_->body_mocapid[id] >= 0 ? " mocap" : "";
      case mjOBJ_JOINT:
        return fmt::format(" {}", m_->jnt_type[id]);
      case mjOBJ_GEOM:
        return fmt::format(" {}", m_->geom_type[id]);
      case mjOBJ_ACTUATOR:
        return fmt::format(" {} {} {}", m_->actuator_trntype[id], m_->actuator_ctrlnum[id],
                           m_->actuator_actnum[id]);
      case mjOBJ_SENSOR:
        return fmt::format(" {} {}", m_->sensor_type[id], m_->sensor_dim[id]);
      case mjOBJ_EQUALITY:
        return fmt::format(" {}", m_->eq_type[id]);
      default:
        return "";
    }
  }

  std::string Owner(mjtObj kind, int id) const {
    switch (kind) {
      case mjOBJ_BODY:
        return Key(mjOBJ_BODY, m_->body_parentid[id]);
      case mjOBJ_JOINT:
        return Key(mjOBJ_BODY, m_->jnt_bodyid[id]);
      case mjOBJ_GEOM:
        return Key(mjOBJ_BODY, m_->geom_bodyid[id]);
      case mjOBJ_SITE:
        return Key(mjOBJ_BODY, m_->site_bodyid[id]);
      case mjOBJ_CAMERA:
        return Key(mjOBJ_BODY, m_->cam_bodyid[id]);
      case mjOBJ_LIGHT:
        return Key(mjOBJ_BODY, m_->light_bodyid[id]);
      case mjOBJ_TENDON:
        return Key(WrapKind(m_->wrap_type[m_->tendon_adr[id]]), m_->wrap_objid[m_->tendon_adr[id]]);
      case mjOBJ_ACTUATOR: {
        const ActuatorTarget target = TargetOf(m_, id);
        return Key(target.kind, target.id);
      }
      case mjOBJ_SENSOR:
        return Key(m_->sensor_objtype[id], m_->sensor_objid[id]);
      case mjOBJ_EQUALITY:
        return Key(m_->eq_objtype[id], m_->eq_obj1id[id]) + " and " +
               Key(m_->eq_objtype[id], m_->eq_obj2id[id]);
      case mjOBJ_PAIR:
        return Key(mjOBJ_GEOM, m_->pair_geom1[id]) + " and " + Key(mjOBJ_GEOM, m_->pair_geom2[id]);
      case mjOBJ_PLUGIN:
        return OwnerOfPlugin(id);
      default:
        return "";
    }
  }

  std::string OwnerOfPlugin(int id) const {
    if (const int a = Referrer(m_->actuator_plugin, m_->nactuator, id); a >= 0)
      return Key(mjOBJ_ACTUATOR, a);
    if (const int s = Referrer(m_->sensor_plugin, m_->nsensor, id); s >= 0)
      return Key(mjOBJ_SENSOR, s);
    if (const int b = Referrer(m_->body_plugin, m_->nbody, id); b >= 0) return Key(mjOBJ_BODY, b);
    if (const int g = Referrer(m_->geom_plugin, m_->ngeom, id); g >= 0) return Key(mjOBJ_GEOM, g);
    return "";
  }

  const mjModel* m_;
  std::map<mjtObj, Keys> keys_;
};

std::vector<int> Match(const Keys& from, const Keys& to) {
  std::unordered_map<std::string_view, int> known;
  for (size_t i = 0; i < from.size(); ++i) known.emplace(from[i], static_cast<int>(i));
  std::vector<int> ids;
  for (const std::string& key : to) {
    const auto at = known.find(key);
    ids.push_back(at == known.end() ? -1 : at->second);
  }
  return ids;
}

}  // namespace

ElementMatch::ElementMatch(const mjModel* from, const mjModel* to) : from_(from), to_(to) {
  const KeyMaker of_from(from), of_to(to);
  for (const mjtObj kind : kMatched) ids_[kind] = Match(of_from.of(kind), of_to.of(kind));
}

}  // namespace robocell
