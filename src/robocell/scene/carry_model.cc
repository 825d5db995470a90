#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string_view>
#include <type_traits>
#include <vector>

#include "robocell/scene/carry_over.h"
#include "robocell/scene/pool.h"

namespace robocell {
namespace {

// Follows from other fields and the whole tree, computed when the model is compiled; or belongs to
// the author, who may give every model another number of them.
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

// Rows that elements have several of: for each row of `to` that of `from`, or -1.
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

// Sums the masses as the engine does, to the bit.
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

// Groups may have other numbers in the new model.
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

}  // namespace

void CarryModel(const ElementMatch& match, mjModel* to) {
  const mjModel* from = match.from();
  const int disabled = to->opt.disableactuator;
  const auto map = to->vis.map;  // of what is visible, by the scene's size
  to->opt = from->opt;
  to->opt.disableactuator = disabled;
  to->vis = from->vis;
  to->vis.map.znear = map.znear;
  to->vis.map.zfar = map.zfar;
  CarryModes(match, to);

  const auto positions = [&](int j) {
    return to->jnt_type[j] == mjJNT_FREE ? 7 : to->jnt_type[j] == mjJNT_BALL ? 4 : 1;
  };
  const auto velocities = [&](int j) {
    return to->jnt_type[j] == mjJNT_FREE ? 6 : to->jnt_type[j] == mjJNT_BALL ? 3 : 1;
  };
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

}  // namespace robocell
