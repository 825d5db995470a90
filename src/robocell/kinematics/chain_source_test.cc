// Tests that writes to a model are noticed exactly if they change the chain.
#include "robocell/kinematics/chain_source.h"

#include <gtest/gtest.h>
#include <mujoco/mjxmacro.h>

#include <type_traits>

#include "robocell/kinematics/testing/engine_says.h"

namespace robocell::internal {
namespace {

// Returns all results of a chain at one configuration.
std::vector<double> AnswersOf(const Chain& chain) {
  const int n = chain.n_joints();
  JointVector q(n), torques(n);
  for (int i = 0; i < n; ++i) q[i] = 0.3 + 0.1 * i;
  chain.GravityTorques(q, {1, 2, 3}, torques);
  Eigen::MatrixXd mass(n, n);
  chain.MassMatrix(q, mass);
  const Eigen::Matrix4d tip = chain.Fk(q).matrix();
  std::vector<double> answers(tip.data(), tip.data() + 16);
  answers.insert(answers.end(), torques.begin(), torques.end());
  answers.insert(answers.end(), mass.data(), mass.data() + mass.size());
  for (const ChainJoint& joint : chain.joints()) {
    answers.insert(answers.end(), {joint.lower, joint.upper, joint.limited ? 1.0 : 0.0});
  }
  return answers;
}

// Changes the real numbers and flags of the model one after the other; calls `check(name)` each
// time.
template <class Check>
void WriteEverywhere(mjModel* m, Check&& check) {
  const auto write = [&](auto* values, size_t count, const char* name) {
    using Number = std::remove_reference_t<decltype(*values)>;
    if constexpr (std::is_same_v<Number, mjtNum> || std::is_same_v<Number, mjtBool>) {
      for (size_t i = 0; i < count; ++i) {
        const Number before = values[i];
        if constexpr (std::is_same_v<Number, mjtNum>) {
          values[i] = before * 1.25 + 0.125;
        } else {
          values[i] = !before;
        }
        check(name);
        values[i] = before;
      }
    }
  };
  MJMODEL_POINTERS_PREAMBLE(m)
#define X(type, name, rows, columns) \
  write(m->name, static_cast<size_t>(m->rows) * static_cast<size_t>(columns), #name);
  MJMODEL_POINTERS
#undef X
  static_cast<void>(nq + nv + na + nu + nmocap + nplastic);
}

void ExpectNoticedWhereItMatters(const TestModel& t, const std::string& base, const ChainTip& tip) {
  mjModel* m = t.model();
  const Chain chain(m, base, tip);
  const std::vector<double> answers = AnswersOf(chain);
  const ChainSource source(m, chain);
  int noticed = 0;
  WriteEverywhere(m, [&](const std::string& name) {
    const bool matters = AnswersOf(Chain(m, base, tip)) != answers;
    EXPECT_TRUE(!matters || source.IsStale(m)) << name << " is read, but is not watched";
    noticed += matters;
    const bool is_far = name.starts_with("geom_") || name.starts_with("mesh_");
    EXPECT_FALSE((is_far || name == "dof_damping") && source.IsStale(m)) << name;
  });
  EXPECT_GT(noticed, 20 * chain.n_joints());
  EXPECT_FALSE(source.IsStale(m));
}

TEST(ChainSource, DetectsEveryRelevantModelEdit) {
  for (int k = 0; k < 4; ++k) {
    Rng rng = Rng::Stream(1, "chain source", k);
    const TestModel t = TestModel::FromXml(RandomChainXml(&rng, {.joints = 1 + 2 * k}).Write());
    ExpectNoticedWhereItMatters(t, "base", ChainTip::Site("tip"));
    ExpectNoticedWhereItMatters(t, "world", ChainTip::Body("link0"));
    ASSERT_FALSE(HasFailure()) << k;
  }
}

TEST(ChainSource, DetectsRotorInertiaAndDisableFlags) {
  const TestModel t = TestModel::FromXml(R"(<mujoco><worldbody><body name="base"><geom size=".1"/>
      <body name="arm" gravcomp=".5"><joint name="a" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/>
      </body></body></worldbody>
      <tendon><fixed name="t" armature=".3"><joint joint="a" coef="2"/></fixed></tendon>
      <actuator><motor joint="a" armature="3e-5" gear="100"/><motor tendon="t" armature=".1"/>
      </actuator></mujoco>)");
  ExpectNoticedWhereItMatters(t, "base", ChainTip::Body("arm"));
  const ChainSource source(t.model(), Chain(t.model(), "base", ChainTip::Body("arm")));
  t.model()->opt.disableflags |= mjDSBL_SPRING | mjDSBL_DAMPER;
  EXPECT_TRUE(source.IsStale(t.model()));
}

TEST(ChainSource, IgnoresOtherModelsAndBodiesOutsideTheChain) {
  const char* two = R"(<mujoco><worldbody><body name="a"><joint/><geom size=".1"/></body>
      <body name="b"><joint/><geom size=".1"/></body></worldbody></mujoco>)";
  const TestModel t = TestModel::FromXml(two), other = TestModel::FromXml(two);
  const ChainSource source(t.model(), Chain(t.model(), "world", ChainTip::Body("a")));
  other.model()->body_mass[1] *= 2;
  EXPECT_FALSE(source.IsStale(other.model()));
  t.model()->body_mass[2] *= 2;
  EXPECT_FALSE(source.IsStale(t.model()));
  t.model()->body_mass[1] *= 2;
  EXPECT_TRUE(source.IsStale(t.model()));
  EXPECT_FALSE(ChainSource().IsStale(t.model()));
}

}  // namespace
}  // namespace robocell::internal
