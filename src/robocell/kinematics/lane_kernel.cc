#include "robocell/kinematics/lane_kernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/kinematics/lane_kernel.cc"
// Without fused multiplication there is little to gain.
// Registers without a fixed size cannot be members.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// While one group waits for its divisions, the processor works on the next.
constexpr int kGroups = 2;

using D = hn::CappedTag<double, kMaxLanes / kGroups>;
using V = hn::Vec<D>;
constexpr D d;

// Damping = kDamping * |error|^2 + kLeastDamping: bold far away would overshoot, cautious near the
// target would crawl (T. Sugihara, "Solvability-Unconcerned Inverse Kinematics by the
// Levenberg-Marquardt Method", 2011).
constexpr double kDamping = 0.01, kLeastDamping = 1e-9;
// Beyond this cost the damping grows no more.
constexpr double kMostCost = 4;
// No hinge turns farther in one step (rad): the linear model holds no longer.
constexpr double kLargestTurn = 1.2;
// Of 2 (1 + cos(angle)): below this the rotation left is nearly half a turn, whose axis is lost in
// the difference between turning this way and that.
constexpr double kNearHalfTurn = 1e-2;

HWY_INLINE V Load(const double* p) { return hn::Load(d, p); }
HWY_INLINE V Number(double value) { return hn::Set(d, value); }

struct V3 {
  V x, y, z;
};
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
// a * s + b
HWY_INLINE V3 MulAdd(V s, const V3& a, const V3& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
HWY_INLINE V3 Times(V s, const V3& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE V3 Sub(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 Add(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
// Turns u towards v by an angle: u' = c u + s v, v' = c v - s u.
HWY_INLINE void Turn(V c, V s, V3* u, V3* v) {
  const V3 turned = {hn::MulAdd(c, u->x, hn::Mul(s, v->x)), hn::MulAdd(c, u->y, hn::Mul(s, v->y)),
                     hn::MulAdd(c, u->z, hn::Mul(s, v->z))};
  *v = {hn::MulSub(c, v->x, hn::Mul(s, u->x)), hn::MulSub(c, v->y, hn::Mul(s, u->y)),
        hn::MulSub(c, v->z, hn::Mul(s, u->z))};
  *u = turned;
}
HWY_INLINE V3 Load3(const double (*rows)[kMaxLanes], int lane) {
  return {Load(rows[0] + lane), Load(rows[1] + lane), Load(rows[2] + lane)};
}

struct Frame {
  V3 x, y, z, p;
};

HWY_INLINE V3 Times(const Frame& f, const double* v) {
  return MulAdd(Number(v[0]), f.x, MulAdd(Number(v[1]), f.y, Times(Number(v[2]), f.z)));
}

HWY_NOINLINE void WholeLink(const PlainTransform& link, Frame* f) {
  const double* r = link.rotation;
  const double x[3] = {r[0], r[3], r[6]}, y[3] = {r[1], r[4], r[7]}, z[3] = {r[2], r[5], r[8]};
  const Frame old = *f;
  f->p = Add(old.p, Times(old, link.translation));
  f->x = Times(old, x);
  f->y = Times(old, y);
  f->z = Times(old, z);
}

HWY_INLINE void LinkTo(const FoldedJoint& joint, Frame* f) {
  if (HWY_UNLIKELY(joint.whole_link)) return WholeLink(joint.link, f);
  f->p = MulAdd(Number(joint.normal_length), f->x, f->p);
  Turn(Number(joint.cos_twist), Number(joint.sin_twist), &f->y, &f->z);
}

// What a step needs of one joint.
struct Axis {
  V3 direction, point;
};

// Frames of all screws at q; the frame of the last one.
template <int N>
HWY_INLINE Frame Walk(const FoldedChain& chain, const V* q, Axis* axes) {
  const int n = N ? N : chain.n;
  V sine[N ? N : kMaxChainJoints], cosine[N ? N : kMaxChainJoints];
  for (int i = 0; i < n; ++i) {
    const FoldedJoint& joint = chain.joints[i];
    if (HWY_UNLIKELY(joint.slide)) {
      sine[i] = Number(joint.sin_angle);
      cosine[i] = Number(joint.cos_angle);
    } else {
      SinCos(d, hn::Add(q[i], Number(joint.angle)), &sine[i], &cosine[i]);
    }
  }
  const V zero = hn::Zero(d), one = Number(1);
  Frame f{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}, {zero, zero, zero}};
  for (int i = 0; i < n; ++i) {
    const FoldedJoint& joint = chain.joints[i];
    if (i > 0) LinkTo(joint, &f);
    V shift = Number(joint.shift);
    if (HWY_UNLIKELY(joint.slide)) shift = hn::MulAdd(q[i], Number(chain.per_metre), shift);
    f.p = MulAdd(shift, f.z, f.p);
    axes[i] = {f.z, f.p};
    Turn(cosine[i], sine[i], &f.x, &f.y);
  }
  return f;
}

// The lower triangle of a symmetric 6 x 6 matrix, row by row, and what it is to be solved for.
struct System {
  V a[21];
  V b[6];
};
HWY_INLINE constexpr int At(int row, int column) { return row * (row + 1) / 2 + column; }

// In place by L D L^T.
HWY_INLINE void Solve(System* s) {
  V inverse[6];
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    inverse[j] = hn::Div(Number(1), s->a[At(j, j)]);
#pragma GCC unroll 6
    for (int i = j + 1; i < 6; ++i) {
      const V factor = hn::Mul(s->a[At(i, j)], inverse[j]);
#pragma GCC unroll 6
      for (int k = j + 1; k <= i; ++k)
        s->a[At(i, k)] = hn::NegMulAdd(factor, s->a[At(k, j)], s->a[At(i, k)]);
      s->b[i] = hn::NegMulAdd(factor, s->b[j], s->b[i]);
    }
  }
#pragma GCC unroll 6
  for (int j = 5; j >= 0; --j) {
    V sum = s->b[j];
#pragma GCC unroll 6
    for (int i = j + 1; i < 6; ++i) sum = hn::NegMulAdd(s->a[At(i, j)], s->b[i], sum);
    s->b[j] = hn::Mul(sum, inverse[j]);
  }
}

// For lanes with nearly half a turn left: some axis of it, from how a vector and its image lie (R +
// 1 is 2 axis axis^T at half a turn), and 2 tan(angle / 2) from the cosine.
HWY_NOINLINE void TurnAround(const Frame& f, const V3& x, const V3& y, const V3& z, const V3& sine2,
                             V cosine2, hn::Mask<D> lanes, V3* angular, V* turn2) {
  const V3 some = {Number(0.48), Number(0.60), Number(0.64)};
  V3 axis = MulAdd(Dot(f.x, some), x, MulAdd(Dot(f.y, some), y, Times(Dot(f.z, some), z)));
  axis = Add(axis, some);
  const V length2 = hn::Max(Dot(axis, axis), Number(1e-12));
  // The way on which the turn is a little shorter.
  const V shorter = hn::CopySign(Number(3), Dot(axis, sine2));
  axis = Times(hn::Div(shorter, hn::Sqrt(length2)), axis);
  angular->x = hn::IfThenElse(lanes, axis.x, angular->x);
  angular->y = hn::IfThenElse(lanes, axis.y, angular->y);
  angular->z = hn::IfThenElse(lanes, axis.z, angular->z);
  const V tangent2 =
      hn::Div(hn::Mul(Number(4), hn::Sub(Number(4), cosine2)), hn::Max(cosine2, Number(1e-3)));
  *turn2 = hn::IfThenElse(lanes, tangent2, *turn2);
}

// What is left to turn: 2 tan(angle / 2) axis, and its squared length, which grows beyond all
// bounds at half a turn.
HWY_INLINE void TurnLeft(const Frame& f, const V3& x, const V3& y, const V3& z, V3* angular,
                         V* turn2) {
  const V3 sine2 = Add(Cross(f.x, x), Add(Cross(f.y, y), Cross(f.z, z)));   // 2 sin(angle) axis
  const V trace = hn::Add(Dot(f.x, x), hn::Add(Dot(f.y, y), Dot(f.z, z)));  // 1 + 2 cos(angle)
  const V cosine2 = hn::Add(trace, Number(1));                              // 2 (1 + cos(angle))
  const V scale = hn::Div(Number(2), hn::Max(cosine2, Number(kNearHalfTurn)));
  *angular = Times(scale, sine2);
  *turn2 = Dot(*angular, *angular);
  const auto half_turn = hn::Lt(cosine2, Number(kNearHalfTurn));
  if (HWY_UNLIKELY(!hn::AllFalse(d, half_turn)))
    TurnAround(f, x, y, z, sine2, cosine2, half_turn, angular, turn2);
}

// What is left to turn when only one axis has to point somewhere: 2 tan(angle / 2) about `about`,
// which is zero where nothing is left.
HWY_INLINE V3 SwingLeft(const LaneTask& task, const Frame& f, const Frame& wanted, V3* about) {
  const V3 now = Times(f, task.axis), then = Times(wanted, task.axis);
  const V3 sine = Cross(now, then);
  const V cosine1 = hn::Add(Dot(now, then), Number(1));  // 1 + cos(angle)
  const V length = hn::Sqrt(hn::Max(Dot(sine, sine), Number(1e-60)));
  // Half a turn may be made about anything across.
  const auto half_turn = hn::Lt(cosine1, Number(0.5 * kNearHalfTurn));
  const V3 across = Cross(now, {Number(0.48), Number(0.60), Number(0.64)});
  const V breadth = hn::Sqrt(hn::Max(Dot(across, across), Number(1e-12)));
  about->x = hn::Div(hn::IfThenElse(half_turn, across.x, sine.x),
                     hn::IfThenElse(half_turn, breadth, length));
  about->y = hn::Div(hn::IfThenElse(half_turn, across.y, sine.y),
                     hn::IfThenElse(half_turn, breadth, length));
  about->z = hn::Div(hn::IfThenElse(half_turn, across.z, sine.z),
                     hn::IfThenElse(half_turn, breadth, length));
  // tan((angle - cone) / 2)
  const V tangent = hn::Div(length, hn::Max(cosine1, Number(0.5 * kNearHalfTurn)));
  const V cone = Number(task.cone);
  const V left = hn::Div(hn::Sub(tangent, cone), hn::MulAdd(tangent, cone, Number(1)));
  const V twice = hn::Min(hn::Max(hn::Add(left, left), hn::Zero(d)), Number(3));
  const auto inside = hn::Le(left, hn::Zero(d));
  const V3 angular = Times(twice, *about);
  if (task.cone > 0) {
    about->x = hn::IfThenZeroElse(inside, about->x);
    about->y = hn::IfThenZeroElse(inside, about->y);
    about->z = hn::IfThenZeroElse(inside, about->z);
  }
  return angular;
}

// Three rows times a vector.
HWY_INLINE V3 TimesRows(const double (*rows)[kMaxLanes], int lane, const V3& v) {
  return {Dot(Load3(rows, lane), v), Dot(Load3(rows + 3, lane), v), Dot(Load3(rows + 6, lane), v)};
}

template <int N, bool kTask>
HWY_INLINE uint32_t StepGroup(const FoldedChain& chain, const LaneOptions& options, int lane,
                              LaneState* state, const LaneTask* task) {
  constexpr int kMost = N ? N : kMaxChainJoints;
  const int n = N ? N : chain.n;
  V q[kMost];
  for (int i = 0; i < n; ++i) q[i] = Load(state->q[i] + lane);
  Axis axes[kMost];
  const Frame f = Walk<N>(chain, q, axes);

  // The twist that takes the tip to where it shall be.
  const V3 tip = Add(f.p, Times(f, chain.tip.translation));
  const V zero = hn::Zero(d);
  V3 linear = Sub(Load3(state->position, lane), tip), angular, about = {zero, zero, zero};
  const V3 x = Load3(state->axes, lane), y = Load3(state->axes + 3, lane),
           z = Load3(state->axes + 6, lane);
  V turn2;
  if (kTask && task->swing) {
    angular = SwingLeft(*task, f, {x, y, z, tip}, &about);
  } else {
    TurnLeft(f, x, y, z, &angular, &turn2);
  }
  V pull = hn::Zero(d);
  if constexpr (kTask) {
    linear = TimesRows(task->linear, lane, linear);
    angular = TimesRows(task->angular, lane, angular);
    turn2 = Dot(angular, angular);
    pull = Load(task->pull + lane);
  }
  const V distance2 = Dot(linear, linear);
  const V cost = hn::Add(distance2, turn2);
  hn::Store(distance2, d, state->distance2 + lane);
  hn::Store(turn2, d, state->turn2 + lane);
  const V best = Load(state->best_cost + lane);
  const auto better = hn::Lt(cost, best);
  hn::Store(hn::IfThenElse(better, cost, best), d, state->best_cost + lane);
  for (int i = 0; i < n; ++i) hn::BlendedStore(q[i], better, d, state->best_q[i] + lane);
  const auto arrived =
      hn::And(hn::Le(distance2, Number(options.distance2)), hn::Le(turn2, Number(options.turn2)));

  System s;
  for (V& entry : s.a) entry = hn::Zero(d);
  const V damping =
      hn::MulAdd(hn::Min(cost, Number(kMostCost)), Number(kDamping), Number(kLeastDamping));
  for (int i = 0; i < 6; ++i) s.a[At(i, i)] = damping;
  s.b[0] = linear.x, s.b[1] = linear.y, s.b[2] = linear.z;
  s.b[3] = angular.x, s.b[4] = angular.y, s.b[5] = angular.z;
  V column[kMost][6], spare[kTask ? kMost : 1], ease[kTask ? kMost : 1];
  for (int i = 0; i < n; ++i) {
    V* c = column[i];
    const FoldedJoint& joint = chain.joints[i];
    V3 moves, turns = axes[i].direction;
    if (HWY_UNLIKELY(joint.slide)) {
      moves = Times(Number(chain.per_metre), turns);
      turns = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    } else {
      moves = Cross(turns, Sub(tip, axes[i].point));
    }
    if constexpr (kTask) {
      moves = TimesRows(task->linear, lane, moves);
      // Along the border of a cone nothing is asked for.
      if (task->cone > 0) turns = Times(Dot(about, turns), about);
      turns = TimesRows(task->angular, lane, turns);
      const V way = hn::Sub(Load(task->goal[i] + lane), q[i]);
      spare[i] =
          options.locked[i] ? hn::Zero(d) : hn::Mul(hn::Mul(pull, Number(task->part[i])), way);
    }
    // A joint that presses on its limit takes no part (projected gradient: D. P. Bertsekas,
    // "Projected Newton Methods for Optimization Problems with Simple Constraints", 1982).
    V push = hn::Add(Dot(moves, linear), Dot(turns, angular));
    if constexpr (kTask) push = hn::Add(push, spare[i]);
    const auto up = hn::Gt(push, hn::Zero(d));
    const auto stuck = hn::Or(hn::And(up, hn::Ge(q[i], Number(joint.upper))),
                              hn::AndNot(up, hn::Le(q[i], Number(joint.lower))));
    c[0] = hn::IfThenZeroElse(stuck, moves.x);
    c[1] = hn::IfThenZeroElse(stuck, moves.y);
    c[2] = hn::IfThenZeroElse(stuck, moves.z);
    c[3] = hn::IfThenZeroElse(stuck, turns.x);
    c[4] = hn::IfThenZeroElse(stuck, turns.y);
    c[5] = hn::IfThenZeroElse(stuck, turns.z);
    if (HWY_UNLIKELY(options.locked[i])) {
      for (int k = 0; k < 6; ++k) c[k] = hn::Zero(d);
    }
    if constexpr (kTask) {
      spare[i] = hn::IfThenZeroElse(stuck, spare[i]);
      const auto at_ease = hn::Gt(pull, hn::Zero(d));
      ease[i] = hn::IfThenElse(at_ease, Number(task->ease[i]), Number(1));
      for (int r = 0; r < 6; ++r) s.b[r] = hn::NegMulAdd(c[r], spare[i], s.b[r]);
    }
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) {
      V row = c[r];
      if constexpr (kTask) row = hn::Mul(row, ease[i]);
#pragma GCC unroll 6
      for (int k = 0; k <= r; ++k) s.a[At(r, k)] = hn::MulAdd(row, c[k], s.a[At(r, k)]);
    }
  }
  Solve(&s);

  V step[kMost];
  V most = hn::Zero(d);
  for (int i = 0; i < n; ++i) {
    const V* c = column[i];
    V sum = hn::Mul(c[0], s.b[0]);
    for (int k = 1; k < 6; ++k) sum = hn::MulAdd(c[k], s.b[k], sum);
    if constexpr (kTask) sum = hn::MulAdd(sum, ease[i], spare[i]);
    step[i] = sum;
    if (!chain.joints[i].slide) most = hn::Max(most, hn::Abs(sum));
  }
  // Slides are linear however far they go.
  auto stay = arrived;
  if constexpr (kTask) stay = hn::And(stay, hn::Le(pull, hn::Zero(d)));
  const V go = hn::IfThenZeroElse(stay, Number(1));
  const V shorten =
      hn::IfThenZeroElse(stay, hn::Div(Number(kLargestTurn), hn::Max(most, Number(kLargestTurn))));
  for (int i = 0; i < n; ++i) {
    if (HWY_UNLIKELY(options.locked[i])) continue;
    const FoldedJoint& joint = chain.joints[i];
    const V part = joint.slide ? go : shorten;
    const V moved = hn::MulAdd(part, step[i], q[i]);
    hn::Store(hn::Min(hn::Max(moved, Number(joint.lower)), Number(joint.upper)), d,
              state->q[i] + lane);
  }
  uint8_t bits[8] = {};
  hn::StoreMaskBits(d, arrived, bits);
  return bits[0];
}

template <int N, bool kTask>
uint32_t Step(const FoldedChain& chain, const LaneOptions& options, uint32_t busy, LaneState* state,
              const LaneTask* task) {
  const int width = hn::Lanes(d);
  uint32_t arrived = 0;
  for (int first = 0; first < kGroups * width; first += width) {
    if ((busy >> first & ((1U << width) - 1)) != 0)
      arrived |= StepGroup<N, kTask>(chain, options, first, state, task) << first;
  }
  return arrived;
}

int Count() { return kGroups * hn::Lanes(d); }

// The common numbers of joints have code of their own, whose arrays the compiler can lay out.
template <bool kTask>
uint32_t StepFor(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                 LaneState* state, const LaneTask* task) {
  switch (chain.n) {
    case 6:
      return Step<6, kTask>(chain, options, busy, state, task);
    case 7:
      return Step<7, kTask>(chain, options, busy, state, task);
    default:
      return Step<0, kTask>(chain, options, busy, state, task);
  }
}

uint32_t StepAny(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                 LaneState* state, const LaneTask* task) {
  return task ? StepFor<true>(chain, options, busy, state, task)
              : StepFor<false>(chain, options, busy, state, nullptr);
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell {

HWY_EXPORT(StepAny);
HWY_EXPORT(Count);

int LaneCount() { return HWY_DYNAMIC_DISPATCH(Count)(); }
int GroupOfLanes() { return LaneCount() / HWY_NAMESPACE::kGroups; }

uint32_t StepLanes(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                   LaneState* state, const LaneTask* task) {
  return HWY_DYNAMIC_DISPATCH(StepAny)(chain, options, busy, state, task);
}

}  // namespace robocell
#endif
