#include "robocell/scene/carry_over.h"

#include <fmt/format.h>
#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/pool.h"

namespace robocell::internal {
namespace {

using Keys = std::vector<std::string>;

// Owners come before their elements.
constexpr mjtObj kMatched[] = {mjOBJ_BODY,     mjOBJ_JOINT,  mjOBJ_GEOM,   mjOBJ_SITE,
                               mjOBJ_CAMERA,   mjOBJ_LIGHT,  mjOBJ_TENDON, mjOBJ_MATERIAL,
                               mjOBJ_ACTUATOR, mjOBJ_SENSOR, mjOBJ_PLUGIN, mjOBJ_EQUALITY,
                               mjOBJ_PAIR};

mjtObj WrapKind(int type) {
  return type == mjWRAP_JOINT ? mjOBJ_JOINT : type == mjWRAP_SITE ? mjOBJ_SITE : mjOBJ_GEOM;
}

// Returns the first of a model's elements that refers to a plugin's instance.
int Referrer(const int* instances, int count, int plugin) {
  for (int i = 0; i < count; ++i) {
    if (instances[i] == plugin) return i;
  }
  return -1;
}

// Makes the keys that identify elements of a model.
class KeyMaker {
 public:
  explicit KeyMaker(const mjModel* m) : m_(m) {
    for (const mjtObj kind : kMatched) AddKeys(kind);
  }
  const Keys& of(mjtObj kind) const { return keys_.at(kind); }

 private:
  void AddKeys(mjtObj kind) {
    Keys& keys = keys_[kind];
    std::unordered_map<std::string, int> unnamed;  // count for each owner so far
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

int PositionsOf(int type) { return type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1; }
int VelocitiesOf(int type) { return type == mjJNT_FREE ? 6 : type == mjJNT_BALL ? 3 : 1; }

// Returns true for a field that follows from other fields and the whole tree, computed when the
// model is compiled, or that belongs to the author, who may give every model another number of
// them.
bool IsNotWritten(std::string_view field) {
  static const std::set<std::string_view> derived = {
      "body_subtreemass", "body_invweight0",   "dof_invweight0", "dof_M0",
      "dof_length",       "cam_poscom0",       "cam_pos0",       "cam_mat0",
      "light_poscom0",    "light_pos0",        "light_dir0",     "tendon_length0",
      "cam_intrinsic",    "tendon_invweight0", "actuator_acc0",  "actuator_length0"};
  return derived.contains(field) || field.ends_with("_user");
}

bool IsMask(std::string_view field) {
  return field.ends_with("_contype") || field.ends_with("_conaffinity");
}

// Rows of elements that have several: for each row of `to` that of `from`, or -1.
using Rows = std::vector<int>;
Rows MatchRows(const std::vector<int>& ids, mjtSize total, const int* from_starts,
               const int* to_starts, const std::function<int(int)>& count) {
  Rows rows(static_cast<size_t>(total), -1);
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < 0) continue;
    for (int k = 0; k < count(static_cast<int>(i)); ++k)
      rows[to_starts[i] + k] = from_starts[ids[i]] + k;
  }
  return rows;
}

template <class T>
void CopyRows(std::string_view field, const Rows& rows, int width, const T* from, T* to) {
  if (IsNotWritten(field) || (!std::is_floating_point_v<T> && !IsMask(field))) return;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] >= 0) std::copy_n(from + width * rows[i], width, to + width * i);
  }
}

int SwitchedOff(const mjModel* m, int actuator) {
  const int group = m->actuator_group[actuator];
  return group >= 0 && group < 31 ? m->opt.disableactuator >> group & 1 : 0;
}

// Sums the masses like the engine does, to the bit.
void SumMasses(mjModel* m) {
  std::copy_n(m->body_mass, m->nbody, m->body_subtreemass);
  for (int b = static_cast<int>(m->nbody) - 1; b > 0; --b)
    m->body_subtreemass[m->body_parentid[b]] += m->body_subtreemass[b];
}

// Flags that the engine checks before the numbers.
void CarryFlags(const mjModel& from, mjModel* to) {
  to->flg_gravcomp = to->flg_gravcomp || from.flg_gravcomp;
  to->flg_surfacevel = to->flg_surfacevel || from.flg_surfacevel;
  to->flg_adhesion = to->flg_adhesion || from.flg_adhesion;
}

// Groups may have different numbers in the new model.
void CarryModes(const ElementMatch& match, mjModel* to) {
  const std::vector<int>& ids = match.of(mjOBJ_ACTUATOR);
  for (int a = 0; a < to->nactuator; ++a) {
    const int group = to->actuator_group[a];
    if (ids[a] < 0 || group < 0 || group > 30) continue;
    const int bit = 1 << group;
    to->opt.disableactuator &= ~bit;
    if (SwitchedOff(match.from(), ids[a])) to->opt.disableactuator |= bit;
  }
}

// A vector of the state that is divided among elements, one after the other: where each begins.
class Pieces {
 public:
  explicit Pieces(mjtSize total) { starts_.insert(static_cast<int>(total)); }
  void Add(const int* addresses, int count) {
    for (int i = 0; i < count; ++i) {
      if (addresses[i] >= 0) starts_.insert(addresses[i]);
    }
  }
  int Length(int start) const { return *starts_.upper_bound(start) - start; }

 private:
  std::set<int> starts_;
};

Pieces HistoryOf(const mjModel* m) {
  Pieces pieces(m->nhistory);
  pieces.Add(m->actuator_historyadr, m->nactuator);
  pieces.Add(m->sensor_historyadr, m->nsensor);
  return pieces;
}

Pieces PlasticOf(const mjModel* m) {
  Pieces pieces(m->nplastic);
  pieces.Add(m->jnt_plasticadr, m->njnt);
  pieces.Add(m->tendon_plasticadr, m->ntendon);
  pieces.Add(m->flex_plasticadr, m->nflex);
  return pieces;
}

// Copies the data of elements of one kind that are in both.
void CopyPieces(const ElementMatch& match, mjtObj kind, const Pieces& from_pieces,
                const Pieces& to_pieces, const int* from_addresses, const int* to_addresses,
                const mjtNum* from, mjtNum* to) {
  const std::vector<int>& ids = match.of(kind);
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < 0 || to_addresses[i] < 0 || from_addresses[ids[i]] < 0) continue;
    const int start = from_addresses[ids[i]], length = from_pieces.Length(start);
    if (length == to_pieces.Length(to_addresses[i]))
      std::copy_n(from + start, length, to + to_addresses[i]);
  }
}

void CarryJoints(const ElementMatch& match, const mjData* from, mjData* to) {
  const mjModel *m = match.from(), *n = match.to();
  const std::vector<int>& ids = match.of(mjOBJ_JOINT);
  for (int j = 0; j < n->njnt; ++j) {
    const int i = ids[j];
    if (i < 0) continue;
    const int type = n->jnt_type[j], at = m->jnt_dofadr[i], dof = n->jnt_dofadr[j];
    std::copy_n(from->qpos + m->jnt_qposadr[i], PositionsOf(type), to->qpos + n->jnt_qposadr[j]);
    std::copy_n(from->qvel + at, VelocitiesOf(type), to->qvel + dof);
    std::copy_n(from->qacc_warmstart + at, VelocitiesOf(type), to->qacc_warmstart + dof);
    std::copy_n(from->qfrc_applied + at, VelocitiesOf(type), to->qfrc_applied + dof);
  }
}

void CarryBodies(const ElementMatch& match, const mjData* from, mjData* to) {
  const mjModel *m = match.from(), *n = match.to();
  const std::vector<int>& ids = match.of(mjOBJ_BODY);
  for (int b = 0; b < n->nbody; ++b) {
    const int i = ids[b];
    if (i < 0) continue;
    std::copy_n(from->xfrc_applied + 6 * i, 6, to->xfrc_applied + 6 * b);
    const int at = m->body_mocapid[i], mocap = n->body_mocapid[b];
    if (at < 0 || mocap < 0) continue;
    std::copy_n(from->mocap_pos + 3 * at, 3, to->mocap_pos + 3 * mocap);
    std::copy_n(from->mocap_quat + 4 * at, 4, to->mocap_quat + 4 * mocap);
  }
}

void CarryActuators(const ElementMatch& match, const mjData* from, mjData* to) {
  const mjModel *m = match.from(), *n = match.to();
  const std::vector<int>& ids = match.of(mjOBJ_ACTUATOR);
  for (int a = 0; a < n->nactuator; ++a) {
    const int i = ids[a];
    if (i < 0) continue;
    std::copy_n(from->ctrl + m->actuator_ctrladr[i], n->actuator_ctrlnum[a],
                to->ctrl + n->actuator_ctrladr[a]);
    if (n->actuator_actadr[a] < 0 || m->actuator_actadr[i] < 0) continue;
    std::copy_n(from->act + m->actuator_actadr[i], n->actuator_actnum[a],
                to->act + n->actuator_actadr[a]);
  }
}

void CarryPieces(const ElementMatch& match, const mjData* from, mjData* to) {
  const mjModel *m = match.from(), *n = match.to();
  const Pieces old_history = HistoryOf(m), history = HistoryOf(n);
  CopyPieces(match, mjOBJ_ACTUATOR, old_history, history, m->actuator_historyadr,
             n->actuator_historyadr, from->history, to->history);
  CopyPieces(match, mjOBJ_SENSOR, old_history, history, m->sensor_historyadr, n->sensor_historyadr,
             from->history, to->history);
  const Pieces old_plastic = PlasticOf(m), plastic = PlasticOf(n);
  CopyPieces(match, mjOBJ_JOINT, old_plastic, plastic, m->jnt_plasticadr, n->jnt_plasticadr,
             from->plastic, to->plastic);
  CopyPieces(match, mjOBJ_TENDON, old_plastic, plastic, m->tendon_plasticadr, n->tendon_plasticadr,
             from->plastic, to->plastic);
  Pieces old_plugins(m->npluginstate), plugins(n->npluginstate);
  old_plugins.Add(m->plugin_stateadr, m->nplugin);
  plugins.Add(n->plugin_stateadr, n->nplugin);
  CopyPieces(match, mjOBJ_PLUGIN, old_plugins, plugins, m->plugin_stateadr, n->plugin_stateadr,
             from->plugin_state, to->plugin_state);
}

}  // namespace

ElementMatch::ElementMatch(const mjModel* from, const mjModel* to) : from_(from), to_(to) {
  const KeyMaker of_from(from), of_to(to);
  for (const mjtObj kind : kMatched) ids_[kind] = Match(of_from.of(kind), of_to.of(kind));
}

void CarryModel(const ElementMatch& match, mjModel* to) {
  const mjModel* from = match.from();
  const int disabled = to->opt.disableactuator;
  const auto map = to->vis.map;  // computed from the scene's size
  to->opt = from->opt;
  to->opt.disableactuator = disabled;
  to->vis = from->vis;
  to->vis.map.znear = map.znear;
  to->vis.map.zfar = map.zfar;
  CarryModes(match, to);

  const auto positions = [&](int j) { return PositionsOf(to->jnt_type[j]); };
  const auto velocities = [&](int j) { return VelocitiesOf(to->jnt_type[j]); };
  const Rows &rows_nbody = match.of(mjOBJ_BODY), &rows_njnt = match.of(mjOBJ_JOINT),
             &rows_ngeom = match.of(mjOBJ_GEOM), &rows_nsite = match.of(mjOBJ_SITE),
             &rows_ncam = match.of(mjOBJ_CAMERA), &rows_nlight = match.of(mjOBJ_LIGHT),
             &rows_nmat = match.of(mjOBJ_MATERIAL), &rows_neq = match.of(mjOBJ_EQUALITY),
             &rows_ntendon = match.of(mjOBJ_TENDON), &rows_nactuator = match.of(mjOBJ_ACTUATOR),
             &rows_nsensor = match.of(mjOBJ_SENSOR), &rows_npair = match.of(mjOBJ_PAIR);
  const Rows rows_nv = MatchRows(rows_njnt, to->nv, from->jnt_dofadr, to->jnt_dofadr, velocities);
  const Rows rows_nq = MatchRows(rows_njnt, to->nq, from->jnt_qposadr, to->jnt_qposadr, positions);
  const Rows rows_nu =
      MatchRows(rows_nactuator, to->nu, from->actuator_ctrladr, to->actuator_ctrladr,
                [&](int a) { return to->actuator_ctrlnum[a]; });
  const Rows rows_nout =
      MatchRows(rows_nactuator, to->nout, from->actuator_outadr, to->actuator_outadr, [&](int a) {
        return std::min(to->actuator_outnum[a], from->actuator_outnum[rows_nactuator[a]]);
      });
  const Rows rows_nJten;
  // The engine's own list of its fields: (type, name, rows, columns).
  constexpr int nuser_body = 0, nuser_jnt = 0, nuser_geom = 0, nuser_site = 0, nuser_cam = 0,
                nuser_tendon = 0, nuser_actuator = 0, nuser_sensor = 0;
#define X(type, name, nr, nc) CopyRows(#name, rows_##nr, nc, from->name, to->name);
#define XNV X
  X(mjtNum, qpos0, nq, 1)
  X(mjtNum, qpos_spring, nq, 1)
  MJMODEL_POINTERS_BODY
  MJMODEL_POINTERS_JOINT
  MJMODEL_POINTERS_DOF
  MJMODEL_POINTERS_GEOM
  MJMODEL_POINTERS_SITE
  MJMODEL_POINTERS_CAMERA
  MJMODEL_POINTERS_LIGHT
  MJMODEL_POINTERS_MATERIAL
  MJMODEL_POINTERS_PAIR
  MJMODEL_POINTERS_EQUALITY
  MJMODEL_POINTERS_TENDON
  MJMODEL_POINTERS_ACTUATOR
  MJMODEL_POINTERS_SENSOR
#undef X
#undef XNV
  SumMasses(to);
  CountCompensatedBodies(to);
  CarryFlags(*from, to);
}

void CarryState(const ElementMatch& match, const mjData* from, mjData* to) {
  CarryJoints(match, from, to);
  CarryBodies(match, from, to);
  CarryActuators(match, from, to);
  CarryPieces(match, from, to);
  const std::vector<int>& equalities = match.of(mjOBJ_EQUALITY);
  for (size_t e = 0; e < equalities.size(); ++e) {
    if (equalities[e] >= 0) to->eq_active[e] = from->eq_active[equalities[e]];
  }
  const mjtSize user = std::min(match.from()->nuserdata, match.to()->nuserdata);
  std::copy_n(from->userdata, user, to->userdata);
  std::copy_n(from->warning, static_cast<int>(mjNWARNING), to->warning);
  to->time = from->time;
}

}  // namespace robocell::internal
