#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>

#include "robocell/scene/carry_over.h"

namespace robocell {
namespace {

int PositionsOf(int type) { return type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1; }
int VelocitiesOf(int type) { return type == mjJNT_FREE ? 6 : type == mjJNT_BALL ? 3 : 1; }

// A vector of the state that elements have pieces of, one after the other: where they begin.
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

}  // namespace robocell
