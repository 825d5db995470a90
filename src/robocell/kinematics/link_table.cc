#include "robocell/kinematics/link_table.h"

#include "robocell/kinematics/chain_model.h"

namespace robocell {

LinkTable Tabulate(const ChainModel& chain) {
  LinkTable table;
  table.n = chain.n;
  for (int i = 0; i < chain.n; ++i) {
    const JointModel& joint = chain.joints[i];
    const LinkInertia& link = joint.link;
    const Eigen::Matrix3d& inertia = link.inertia;
    for (int k = 0; k < 9; ++k) table.rotation[k][i] = joint.fixed.rotation.data()[k];
    table.reference[i] = joint.reference;
    (joint.slide ? table.slides : table.turns)[i] = 1;
    table.mass[i] = link.mass;
    table.weight_mass[i] = link.weight_mass;
    for (int k = 0; k < 3; ++k) {
      if (i > 0) table.translation[k][i] = joint.fixed.translation[k];
      table.moment[k][i] = link.moment[k];
      table.weight_moment[k][i] = link.weight_moment[k];
      table.inertia[k][i] = inertia(k, k);
    }
    table.inertia[3][i] = inertia(0, 1);
    table.inertia[4][i] = inertia(0, 2);
    table.inertia[5][i] = inertia(1, 2);
    table.armature[i] = joint.armature;
  }
  double mass = 0, weight = 0;
  for (int i = chain.n - 1; i >= 0; --i) {
    table.mass_behind[i] = mass += table.mass[i];
    table.weight_behind[i] = weight += table.weight_mass[i];
  }
  for (int k = 0; k < 3; ++k) {
    table.origin[k] = chain.joints[0].fixed.translation[k];
    table.tip_translation[k] = chain.last_to_tip.translation[k];
  }
  for (int k = 0; k < 9; ++k) table.tip_rotation[k] = chain.last_to_tip.rotation.data()[k];
  return table;
}

}  // namespace robocell
