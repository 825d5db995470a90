// Tests that starts come in order of nearness, lie inside the limits, and exist for every pose.
#include "robocell/kinematics/start_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

class StartTableTest : public testing::Test {
 protected:
  Transform TipAt(const float* q) const {
    const std::vector<double> values(q, q + chain_.n_joints());
    return ToTransform(chain_.Fk(values));
  }
  // Returns the distance between two poses in metres and in radians.
  static double Away(const Transform& a, const Transform& b) {
    return (a.translation - b.translation).norm() +
           Eigen::AngleAxisd(a.rotation * b.rotation.transpose()).angle();
  }

  Rng rng_ = Rng::Stream(1, "start table");
  TestModel model_ = TestModel::FromXml(
      RandomChainXml(&rng_, {.joints = 7, .slide_share = 0, .limited_share = 1}).Write());
  Chain chain_{model_.model(), "base", ChainTip::Site("tip")};
  StartTable table_{chain_.model()};
};

TEST_F(StartTableTest, AreSortedFiniteAndWithinTheLimits) {
  const StartTable::Aim aim = StartTable::At(TipAt(std::vector<float>(7).data()), false);
  StartTable::Place place;
  int count = 0;
  for (StartTable::Place before; const float* q = table_.Next(aim, &place); before = place) {
    ++count;
    ASSERT_TRUE(place.score > before.score ||
                (place.score == before.score && place.entry > before.entry));
    for (int i = 0; i < 7; ++i) {
      EXPECT_GE(q[i], chain_.joints()[i].lower);
      EXPECT_LE(q[i], chain_.joints()[i].upper);
    }
  }
  EXPECT_GE(count, 8);
}

TEST_F(StartTableTest, AreTheSameTogetherAndOneByOne) {
  for (int k = 0; k < 50; ++k) {
    std::vector<float> q(7);
    for (float& value : q) value = static_cast<float>(rng_.Uniform(-1, 1));
    const StartTable::Aim aim = StartTable::At(TipAt(q.data()), k % 5 == 0);
    for (const int most : {1, 7, 16, 8192}) {
      std::vector<StartTable::Place> together(most);
      const int count = table_.First(aim, together);
      StartTable::Place place;
      int one = 0;
      while (one < most) {
        const float* start = table_.Next(aim, &place);
        if (!start) break;
        ASSERT_LT(one, count);
        EXPECT_EQ(table_.Values(together[one]), start);
        EXPECT_EQ(together[one].score, place.score);
        ++one;
      }
      EXPECT_EQ(one, count);
    }
  }
}

// Starts whose joints are all alike fail alike.
TEST_F(StartTableTest, AreSkippedIfSimilarToEarlierOnes) {
  const StartTable::Aim aim = StartTable::At(TipAt(std::vector<float>(7).data()), false);
  std::vector<StartTable::Place> tried;
  StartTable::Place place;
  int all = 0;
  for (StartTable::Place any; table_.Next(aim, &any) != nullptr;) ++all;
  while (table_.Next(aim, &place, tried) != nullptr) {
    const float* q = table_.Values(place);
    for (const StartTable::Place& other : tried) {
      float most = 0;
      for (int i = 0; i < 7; ++i) most = std::max(most, std::abs(q[i] - table_.Values(other)[i]));
      EXPECT_GE(most, 1.5F);
    }
    if (!tried.empty()) {
      EXPECT_GE(place.score, tried.back().score);
    }
    tried.push_back(place);
  }
  EXPECT_GT(tried.size(), 1u);
  EXPECT_LT(static_cast<int>(tried.size()), all);
}

// A tip that may turn about an axis is equally near in every turn about it.
TEST_F(StartTableTest, DoNotDependOnRotationAboutTheFreeAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  Transform target = TipAt(std::vector<float>(7, 0.3F).data());
  StartTable::Place first, turned;
  const float* start = table_.Next(StartTable::At(target, false, &axis), &first);
  const Eigen::Vector3d there = target.rotation * axis;
  for (const double angle : {0.7, 2.0, 3.1}) {
    target.rotation *= Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    turned = {};
    EXPECT_EQ(table_.Next(StartTable::At(target, false, &axis), &turned), start);
    EXPECT_NEAR(turned.score, first.score, 1e-4);
  }
  // The distance of the axis itself counts: 8 (1 - cos(angle / 2)) of that.
  const Transform tip = TipAt(start);
  const double off = std::acos(std::clamp((tip.rotation * axis).dot(there), -1.0, 1.0));
  target.translation = tip.translation;
  StartTable::Place here;
  table_.Next(StartTable::At(target, false, &axis), &here);
  EXPECT_LE(here.score, 8 * (1 - std::cos(off / 2)) + 1e-4);
}

TEST_F(StartTableTest, AreNearerThanTheCentre) {
  double first = 0, middle = 0;
  const JointVector centre(7);
  for (int k = 0; k < 200; ++k) {
    JointVector q(7);
    for (int i = 0; i < 7; ++i)
      q[i] = rng_.Uniform(chain_.joints()[i].lower, chain_.joints()[i].upper);
    const Transform target = ToTransform(chain_.Fk(q));
    StartTable::Place place;
    const float* start = table_.Next(StartTable::At(target, false), &place);
    ASSERT_NE(start, nullptr);
    first += Away(TipAt(start), target);
    middle += Away(ToTransform(chain_.Fk(centre)), target);
  }
  EXPECT_LT(first, 0.5 * middle);
}

TEST_F(StartTableTest, ExistForUnreachablePoses) {
  for (const double far : {3.0, 1e6, 1e300}) {
    StartTable::Place place;
    const Transform target{Eigen::Matrix3d::Identity(), {far, -far, far}};
    const float* start = table_.Next(StartTable::At(target, false), &place);
    ASSERT_TRUE(start != nullptr || far == 1e300) << far;
  }
}

// All configurations put the tip at the same place.
TEST(StartTable, CanHaveASinglePlace) {
  ChainModel chain;
  chain.n = 1;
  chain.joints[0].lower = -1;
  chain.joints[0].upper = 1;
  const StartTable table(chain);
  for (const double far : {0.0, 1.0, 1e39, 1e300}) {
    StartTable::Place place;
    table.Next(StartTable::At({Eigen::Matrix3d::Identity(), {far, -far, 0}}, false), &place);
    EXPECT_EQ(place.entry >= 0, far < 1e19) << far;
  }
}

}  // namespace
}  // namespace robocell::internal
