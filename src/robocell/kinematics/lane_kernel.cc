#include "robocell/kinematics/lane_kernel.h"

#include <algorithm>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "robocell/kinematics/lane_kernel.cc"
// Without fused multiplication there is little to gain.
// Registers without a fixed size cannot be members.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "robocell/kinematics/lane_math-inl.h"
#include "robocell/kinematics/lane_six-inl.h"
#include "robocell/kinematics/link_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// While one group waits for its divisions, the processor works on the next.
constexpr int kGroups = 2;
// Lanes for one query. More lanes hardly find a solution sooner.
constexpr int kMostOfOneQuery = 4;

// Damping = kDamping * |error|^2 + kLeastDamping: little damping far away would overshoot, much
// damping near the target would crawl (T. Sugihara, "Solvability-Unconcerned Inverse Kinematics by
// the Levenberg-Marquardt Method", 2011).
constexpr double kDamping = 0.01, kLeastDamping = 1e-9;
// Beyond this cost the damping no longer grows.
constexpr double kMostCost = 4;
// Largest turn of a hinge in one step (rad), beyond which the linear model fails.
constexpr double kLargestTurn = 1.2;
// Bound of 2 (1 + cos(angle)): below it the remaining rotation is nearly half a turn, whose axis
// cannot be computed from the difference between both directions.
constexpr double kNearHalfTurn = 1e-2;

template <class V>
HWY_INLINE Vec3<V> Times(const Frame3<V>& f, const double* v) {
  constexpr hn::DFromV<V> d;
  return MulAdd(hn::Set(d, v[0]), f.x, MulAdd(hn::Set(d, v[1]), f.y, Times(hn::Set(d, v[2]), f.z)));
}

// Storage for the joints of a chain of N; 0: of any number.
template <int N>
inline constexpr int kMostJoints = N ? N : kMaxChainJoints;

// A step of the lanes of one register of type D.
template <class D>
struct LaneStep {
  using V = hn::Vec<D>;
  static constexpr D d = {};
  // A single query waits for each number that the next one depends on. A predicted branch avoids
  // the wait there; with several lanes one of them often takes the other branch.
  static constexpr bool kAlone = hn::MaxLanes(D()) == 1;

  static HWY_INLINE V Load(const double* p) { return hn::Load(d, p); }
  static HWY_INLINE V Number(double value) { return hn::Set(d, value); }

  using V3 = Vec3<V>;
  using Frame = Frame3<V>;

  // Turns u towards v by an angle: u' = c u + s v, v' = c v - s u.
  static HWY_INLINE void Turn(V c, V s, V3* u, V3* v) {
    const V3 turned = {hn::MulAdd(c, u->x, hn::Mul(s, v->x)), hn::MulAdd(c, u->y, hn::Mul(s, v->y)),
                       hn::MulAdd(c, u->z, hn::Mul(s, v->z))};
    *v = {hn::MulSub(c, v->x, hn::Mul(s, u->x)), hn::MulSub(c, v->y, hn::Mul(s, u->y)),
          hn::MulSub(c, v->z, hn::Mul(s, u->z))};
    *u = turned;
  }
  static HWY_INLINE V3 Load3(const double (*rows)[kMaxLanes], int lane) {
    return {Load(rows[0] + lane), Load(rows[1] + lane), Load(rows[2] + lane)};
  }

  // Rare, but inlined: the call would force the frame into memory all the time.
  static HWY_INLINE void WholeLink(const PlainTransform& link, Frame* f) {
    const double* r = link.rotation;
    const double x[3] = {r[0], r[3], r[6]}, y[3] = {r[1], r[4], r[7]}, z[3] = {r[2], r[5], r[8]};
    const V3 to_x = Times(*f, x), to_y = Times(*f, y), to_z = Times(*f, z);
    f->p = Add(f->p, Times(*f, link.translation));
    f->x = to_x;
    f->y = to_y;
    f->z = to_z;
  }

  static HWY_INLINE void LinkTo(const FoldedJoint& joint, Frame* f) {
    if (HWY_UNLIKELY(joint.whole_link)) return WholeLink(joint.link, f);
    f->p = MulAdd(Number(joint.normal_length), f->x, f->p);
    Turn(Number(joint.cos_twist), Number(joint.sin_twist), &f->y, &f->z);
  }

  // The data of one joint that a step needs.
  struct Axis {
    V3 direction, point;
  };

  // Combines numbers of one lane into one register. (Loading numbers together that were stored one
  // by one causes a wait.) Argument types select Combine: it does nothing where it is not needed.
  template <class Several>
  static HWY_INLINE hn::Vec<Several> Together(Several several, const V* each) {
    constexpr int kHalf = hn::MaxLanes(several) / 2;
    if constexpr (kHalf == 0) {
      return each[0];
    } else {
      constexpr hn::Half<Several> half;
      return Combine(several, Together(half, each + kHalf), Together(half, each));
    }
  }

  // Computes the turns of all screws with one lane: those of several joints at once.
  template <int N>
  static HWY_INLINE void TurnsOfOne(const FoldedChain& chain, const V* q, V* sine, V* cosine) {
    constexpr hn::CappedTag<double, 4> several;
    constexpr int kTogether = hn::MaxLanes(several);
    constexpr int kRoom = (kMostJoints<N> + 3) / 4 * 4;
    alignas(32) double sines[kRoom], cosines[kRoom];
    V angle[kRoom];
    const int n = N ? N : chain.n;
    for (V& each : angle) each = hn::Zero(d);
    for (int i = 0; i < n; ++i) {
      if (!chain.joints[i].slide) angle[i] = hn::Add(q[i], Number(chain.joints[i].angle));
    }
    for (int i = 0; i < n; i += kTogether) {
      hn::Vec<decltype(several)> s, c;
      SinCos(several, Together(several, angle + i), &s, &c);
      hn::Store(s, several, sines + i);
      hn::Store(c, several, cosines + i);
    }
    for (int i = 0; i < n; ++i) {
      const FoldedJoint& joint = chain.joints[i];
      sine[i] = Number(joint.slide ? joint.sin_angle : sines[i]);
      cosine[i] = Number(joint.slide ? joint.cos_angle : cosines[i]);
    }
  }

  template <int N>
  static HWY_INLINE void TurnsOf(const FoldedChain& chain, const V* q, V* sine, V* cosine) {
    if constexpr (kAlone) return TurnsOfOne<N>(chain, q, sine, cosine);
    const int n = N ? N : chain.n;
    for (int i = 0; i < n; ++i) {
      const FoldedJoint& joint = chain.joints[i];
      if (HWY_UNLIKELY(joint.slide)) {
        sine[i] = Number(joint.sin_angle);
        cosine[i] = Number(joint.cos_angle);
      } else {
        SinCos(d, hn::Add(q[i], Number(joint.angle)), &sine[i], &cosine[i]);
      }
    }
  }

  // Returns the shift of a screw along its axis.
  static HWY_INLINE V ShiftOf(const FoldedChain& chain, int i, const V* q) {
    const FoldedJoint& joint = chain.joints[i];
    const V shift = Number(joint.shift);
    return HWY_UNLIKELY(joint.slide) ? hn::MulAdd(q[i], Number(chain.per_metre), shift) : shift;
  }

  // Computes the frames of all screws at q and returns that of the last one.
  template <int N>
  static HWY_INLINE Frame Walk(const FoldedChain& chain, const V* q, Axis* axes) {
    const int n = N ? N : chain.n;
    V sine[kMostJoints<N>], cosine[kMostJoints<N>];
    TurnsOf<N>(chain, q, sine, cosine);
    const V zero = hn::Zero(d);
    Frame f{.x = {cosine[0], sine[0], zero},
            .y = {hn::Neg(sine[0]), cosine[0], zero},
            .z = {zero, zero, Number(1)},
            .p = {zero, zero, ShiftOf(chain, 0, q)}};
    axes[0] = {f.z, f.p};
    for (int i = 1; i < n; ++i) {
      LinkTo(chain.joints[i], &f);
      f.p = MulAdd(ShiftOf(chain, i, q), f.z, f.p);
      axes[i] = {f.z, f.p};
      Turn(cosine[i], sine[i], &f.x, &f.y);
    }
    return f;
  }

  // Computes, for lanes that are nearly half a turn away, an axis from a vector and its image (R +
  // 1 is 2 axis axis^T at half a turn), and 2 tan(angle / 2) from the cosine. Inlined, as above.
  static HWY_INLINE void TurnAround(const Frame& f, const V3& x, const V3& y, const V3& z,
                                    const V3& sine2, V cosine2, hn::Mask<D> lanes, V3* angular,
                                    V* turn2) {
    const V3 some = {Number(0.48), Number(0.60), Number(0.64)};
    V3 axis = MulAdd(Dot(f.x, some), x, MulAdd(Dot(f.y, some), y, Times(Dot(f.z, some), z)));
    axis = Add(axis, some);
    const V length2 = hn::Max(Dot(axis, axis), Number(1e-12));
    // Takes the direction in which the turn is slightly shorter.
    const V shorter = hn::CopySign(Number(3), Dot(axis, sine2));
    axis = Times(hn::Div(shorter, hn::Sqrt(length2)), axis);
    angular->x = hn::IfThenElse(lanes, axis.x, angular->x);
    angular->y = hn::IfThenElse(lanes, axis.y, angular->y);
    angular->z = hn::IfThenElse(lanes, axis.z, angular->z);
    const V tangent2 =
        hn::Div(hn::Mul(Number(4), hn::Sub(Number(4), cosine2)), hn::Max(cosine2, Number(1e-3)));
    *turn2 = hn::IfThenElse(lanes, tangent2, *turn2);
  }

  // Computes the remaining rotation as 2 tan(angle / 2) axis, and its squared length, which grows
  // beyond all bounds at half a turn.
  static HWY_INLINE void TurnLeft(const Frame& f, const V3& x, const V3& y, const V3& z,
                                  V3* angular, V* turn2) {
    const V3 sine2 = Add(Cross(f.x, x), Add(Cross(f.y, y), Cross(f.z, z)));   // 2 sin(angle) axis
    const V trace = hn::Add(Dot(f.x, x), hn::Add(Dot(f.y, y), Dot(f.z, z)));  // 1 + 2 cos(angle)
    const V cosine2 = hn::Add(trace, Number(1));                              // 2 (1 + cos(angle))
    const V scale = hn::Div(Number(2), hn::Max(cosine2, Number(kNearHalfTurn)));
    *angular = Times(scale, sine2);
    *turn2 = hn::Mul(hn::Mul(scale, scale), Dot(sine2, sine2));
    const auto half_turn = hn::Lt(cosine2, Number(kNearHalfTurn));
    if (HWY_UNLIKELY(!hn::AllFalse(d, half_turn)))
      TurnAround(f, x, y, z, sine2, cosine2, half_turn, angular, turn2);
  }

  // Computes the tangent of half the angle from the cosine, for lanes in which an axis points
  // nearly the opposite way; any axis across may be used.
  static HWY_NOINLINE void SwingAround(const V3& now, V cosine1, hn::Mask<D> lanes, V3* about,
                                       V* tangent) {
    const V3 across = Cross(now, {Number(0.48), Number(0.60), Number(0.64)});
    const V breadth = hn::Sqrt(hn::Max(Dot(across, across), Number(1e-12)));
    about->x = hn::IfThenElse(lanes, hn::Div(across.x, breadth), about->x);
    about->y = hn::IfThenElse(lanes, hn::Div(across.y, breadth), about->y);
    about->z = hn::IfThenElse(lanes, hn::Div(across.z, breadth), about->z);
    const V tangent2 = hn::Div(hn::Sub(Number(2), cosine1), hn::Max(cosine1, Number(1e-12)));
    *tangent = hn::IfThenElse(lanes, hn::Sqrt(tangent2), *tangent);
  }

  // The same if only one axis has to point in a direction: 2 tan(angle / 2) about `about`, which is
  // zero if nothing remains.
  static HWY_INLINE void SwingLeft(const LaneTask& task, int lane, const Frame& f, const V3& x,
                                   const V3& y, const V3& z, V3* angular, V* turn2, V3* about) {
    const V3 now = Times(f, task.axis);
    const V3 then = MulAdd(Number(task.axis[0]), x,
                           MulAdd(Number(task.axis[1]), y, Times(Number(task.axis[2]), z)));
    const V3 sine = Cross(now, then);
    const V cosine1 = hn::Add(Dot(now, then), Number(1));  // 1 + cos(angle)
    const V length = hn::Sqrt(hn::Max(Dot(sine, sine), Number(1e-60)));
    *about = {hn::Div(sine.x, length), hn::Div(sine.y, length), hn::Div(sine.z, length)};
    V tangent = hn::Div(length, hn::Max(cosine1, Number(0.5 * kNearHalfTurn)));
    const auto half_turn = hn::Lt(cosine1, Number(0.5 * kNearHalfTurn));
    if (HWY_UNLIKELY(!hn::AllFalse(d, half_turn)))
      SwingAround(now, cosine1, half_turn, about, &tangent);
    // tan((angle - cone) / 2)
    const V cone = Number(task.cone);
    const V left = hn::Div(hn::Sub(tangent, cone), hn::MulAdd(tangent, cone, Number(1)));
    const V twice = hn::Max(hn::Add(left, left), hn::Zero(d));
    *turn2 = hn::Mul(twice, twice);
    V turn = twice;
    if (task.cone > 0) {
      const auto to_axis = hn::Gt(Load(task.to_axis + lane), hn::Zero(d));
      turn = hn::IfThenElse(to_axis, hn::Add(tangent, tangent), twice);
    }
    *angular = Times(hn::Min(turn, Number(3)), *about);
    if (task.cone > 0) {
      const auto inside = hn::Le(left, hn::Zero(d));
      about->x = hn::IfThenZeroElse(inside, about->x);
      about->y = hn::IfThenZeroElse(inside, about->y);
      about->z = hn::IfThenZeroElse(inside, about->z);
    }
  }

  // Multiplies three rows by a vector.
  static HWY_INLINE V3 TimesRows(const double (*rows)[kMaxLanes], int lane, const V3& v) {
    return {Dot(Load3(rows, lane), v), Dot(Load3(rows + 3, lane), v),
            Dot(Load3(rows + 6, lane), v)};
  }

  // The pose error of the tip, and its cost.
  struct Residual {
    V3 linear, angular;
    V3 about;  // axis of a swing
    V distance2, turn2, cost;
    V pull;  // pull on redundant joints
  };

  template <bool kTask>
  static HWY_INLINE Residual Measure(const Frame& f, const V3& tip, int lane, const LaneTask* task,
                                     const LaneState& state) {
    const V zero = hn::Zero(d);
    Residual residual;
    residual.linear = Sub(Load3(state.position, lane), tip);
    residual.about = {zero, zero, zero};
    residual.pull = zero;
    const V3 x = Load3(state.axes, lane), y = Load3(state.axes + 3, lane),
             z = Load3(state.axes + 6, lane);
    if (kTask && task->swing) {
      SwingLeft(*task, lane, f, x, y, z, &residual.angular, &residual.turn2, &residual.about);
    } else {
      TurnLeft(f, x, y, z, &residual.angular, &residual.turn2);
    }
    if constexpr (kTask) {
      residual.linear = TimesRows(task->linear, lane, residual.linear);
      const V whole2 = hn::Max(Dot(residual.angular, residual.angular), Number(1e-60));
      residual.angular = TimesRows(task->angular, lane, residual.angular);
      // Far away the displacement of a step is shorter than the remaining one.
      const V share = hn::Div(residual.turn2, whole2);
      residual.turn2 = hn::Mul(share, Dot(residual.angular, residual.angular));
      residual.pull = Load(task->pull + lane);
    }
    residual.distance2 = Dot(residual.linear, residual.linear);
    residual.cost = hn::Add(residual.distance2, residual.turn2);
    return residual;
  }

  // Stores the measured errors, and keeps the best.
  static HWY_INLINE void Note(const Residual& residual, int n, const V* q, int lane,
                              LaneState* state) {
    hn::Store(residual.distance2, d, state->distance2 + lane);
    hn::Store(residual.turn2, d, state->turn2 + lane);
    const V best = Load(state->best_cost + lane);
    const auto better = hn::Lt(residual.cost, best);
    hn::Store(hn::IfThenElse(better, residual.cost, best), d, state->best_cost + lane);
    if (kAlone && hn::AllFalse(d, better)) return;
    for (int i = 0; i < n; ++i) {
      if constexpr (kAlone) {
        hn::Store(q[i], d, state->best_q[i] + lane);
      } else {
        hn::BlendedStore(q[i], better, d, state->best_q[i] + lane);
      }
    }
  }

  struct Limits {
    V lower, upper;
  };
  template <bool kRoams>
  static HWY_INLINE Limits LimitsOf(const FoldedJoint& joint, V roam) {
    const Limits own = {Number(joint.lower), Number(joint.upper)};
    if (!kRoams || !joint.has_whole_turn) return own;
    return {hn::Sub(own.lower, roam), hn::Add(own.upper, roam)};
  }

  // The equations of a step: the lower triangle of a symmetric matrix, and the right-hand side.
  struct Equations {
    V a[kEntries], b[6];
  };

  // The joints: columns of the Jacobian, a secondary objective, and how easily they move. Slides
  // move by lengths of the chain, so that damping is independent of metres.
  template <int N, bool kTask>
  struct Moves {
    static constexpr int kMost = kMostJoints<N>;
    V column[kMost][6], spare[kTask ? kMost : 1], ease[kTask ? kMost : 1];
  };

  // A column of the Jacobian.
  struct Column {
    V3 moves, turns;
  };
  static HWY_INLINE Column ColumnOf(const FoldedJoint& joint, const Axis& axis, const V3& tip) {
    if (HWY_UNLIKELY(joint.slide)) return {axis.direction, {hn::Zero(d), hn::Zero(d), hn::Zero(d)}};
    return {Cross(axis.direction, Sub(tip, axis.point)), axis.direction};
  }

  template <bool kFirst, bool kRoams, int N, bool kTask>
  static HWY_INLINE void AddJoint(const FoldedChain& chain, const LaneOptions& options, int i, V q,
                                  V roam, const Column& column, int lane, const LaneTask* task,
                                  const Residual& residual, Moves<N, kTask>* joints, Equations* e) {
    V* c = joints->column[i];
    const FoldedJoint& joint = chain.joints[i];
    V3 moves = column.moves, turns = column.turns;
    if constexpr (kTask) {
      moves = TimesRows(task->linear, lane, moves);
      // Along the border of a cone nothing is required.
      if (task->cone > 0) {
        const auto to_axis = hn::Gt(Load(task->to_axis + lane), hn::Zero(d));
        const V3 across = Times(Dot(residual.about, turns), residual.about);
        turns = {hn::IfThenElse(to_axis, turns.x, across.x),
                 hn::IfThenElse(to_axis, turns.y, across.y),
                 hn::IfThenElse(to_axis, turns.z, across.z)};
      }
      turns = TimesRows(task->angular, lane, turns);
      V to_goal = hn::Sub(Load(task->goal[i] + lane), q);
      if (HWY_UNLIKELY(joint.slide)) to_goal = hn::Mul(Number(chain.per_metre), to_goal);
      joints->spare[i] = options.locked[i]
                             ? hn::Zero(d)
                             : hn::Mul(hn::Mul(residual.pull, Number(task->part[i])), to_goal);
    }
    c[0] = moves.x, c[1] = moves.y, c[2] = moves.z;
    c[3] = turns.x, c[4] = turns.y, c[5] = turns.z;
    // A joint that presses on its limit takes no part (projected gradient: D. P. Bertsekas,
    // "Projected Newton Methods for Optimization Problems with Simple Constraints", 1982).
    const Limits limits = LimitsOf<kRoams>(joint, roam);
    const auto above = hn::Ge(q, limits.upper), below = hn::Le(q, limits.lower);
    const bool seldom = kAlone || (kRoams && joint.has_whole_turn);
    if (!seldom || HWY_UNLIKELY(!hn::AllFalse(d, hn::Or(above, below)))) {
      V push = hn::Add(Dot(moves, residual.linear), Dot(turns, residual.angular));
      if constexpr (kTask) push = hn::Add(push, joints->spare[i]);
      const auto up = hn::Gt(push, hn::Zero(d));
      const auto stuck = hn::Or(hn::And(up, above), hn::AndNot(up, below));
      for (int k = 0; k < 6; ++k) c[k] = hn::IfThenZeroElse(stuck, c[k]);
      if constexpr (kTask) joints->spare[i] = hn::IfThenZeroElse(stuck, joints->spare[i]);
    }
    if (HWY_UNLIKELY(options.locked[i])) {
      for (int k = 0; k < 6; ++k) c[k] = hn::Zero(d);
    }
    if constexpr (kTask) {
      const auto at_ease = hn::Gt(residual.pull, hn::Zero(d));
      joints->ease[i] = hn::IfThenElse(at_ease, Number(task->ease[i]), Number(task->share[i]));
      for (int r = 0; r < 6; ++r) e->b[r] = hn::NegMulAdd(c[r], joints->spare[i], e->b[r]);
    }
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) {
      V row = c[r];
      if constexpr (kTask) row = hn::Mul(row, joints->ease[i]);
#pragma GCC unroll 6
      for (int k = 0; k <= r; ++k) {
        V& sum = e->a[Entry(r, k)];
        sum = kFirst ? hn::Mul(row, c[k]) : hn::MulAdd(row, c[k], sum);
      }
    }
  }

  // Computes the damped step that moves the tip towards its target. `column` returns that of a
  // joint.
  template <bool kRoams, int N, bool kTask, class ColumnAt>
  static HWY_INLINE void Assemble(const FoldedChain& chain, const LaneOptions& options, const V* q,
                                  V roam, const ColumnAt& column, int lane, const LaneTask* task,
                                  const Residual& residual, Moves<N, kTask>* joints, Equations* e) {
    const int n = N ? N : chain.n;
    e->b[0] = residual.linear.x, e->b[1] = residual.linear.y, e->b[2] = residual.linear.z;
    e->b[3] = residual.angular.x, e->b[4] = residual.angular.y, e->b[5] = residual.angular.z;
    AddJoint<true, kRoams>(chain, options, 0, q[0], roam, column(0), lane, task, residual, joints,
                           e);
    for (int i = 1; i < n; ++i)
      AddJoint<false, kRoams>(chain, options, i, q[i], roam, column(i), lane, task, residual,
                              joints, e);
    const V damping =  // which is known last
        hn::MulAdd(hn::Min(residual.cost, Number(kMostCost)), Number(kDamping),
                   Number(kLeastDamping));
    for (int i = 0; i < 6; ++i) e->a[Entry(i, i)] = hn::Add(e->a[Entry(i, i)], damping);
  }

  // Moves the lanes that do not stay, by the solution of the equations.
  template <bool kRoams, int N, bool kTask>
  static HWY_INLINE void Advance(const FoldedChain& chain, const LaneOptions& options, const V* q,
                                 V roam, const Moves<N, kTask>& joints, const Equations& e,
                                 hn::Mask<D> stay, int lane, LaneState* state) {
    const int n = N ? N : chain.n;
    V step[Moves<N, kTask>::kMost];
    V most = hn::Zero(d);
    for (int i = 0; i < n; ++i) {
      const V* c = joints.column[i];
      V sum = hn::Mul(c[5], e.b[5]);  // in the order of computation
      for (int k = 4; k >= 0; --k) sum = hn::MulAdd(c[k], e.b[k], sum);
      if constexpr (kTask) sum = hn::MulAdd(sum, joints.ease[i], joints.spare[i]);
      step[i] = sum;
      if (!chain.joints[i].slide) most = hn::Max(most, hn::Abs(sum));
    }
    V shorten = hn::IfThenZeroElse(stay, Number(1));
    // Slides are linear at any distance.
    const V slide = hn::IfThenZeroElse(stay, Number(chain.length));
    if (!kAlone || HWY_UNLIKELY(!hn::AllFalse(d, hn::Gt(most, Number(kLargestTurn)))))
      shorten = hn::IfThenZeroElse(
          stay, hn::Div(Number(kLargestTurn), hn::Max(most, Number(kLargestTurn))));
    for (int i = 0; i < n; ++i) {
      if (HWY_UNLIKELY(options.locked[i])) continue;
      const FoldedJoint& joint = chain.joints[i];
      const V part = joint.slide ? slide : shorten;
      const V moved = hn::MulAdd(part, step[i], q[i]);
      const Limits limits = LimitsOf<kRoams>(joint, roam);
      hn::Store(hn::Min(hn::Max(moved, limits.lower), limits.upper), d, state->q[i] + lane);
    }
  }

  // All joints of a chain in which some follow others.
  struct CoupledJoints {
    V q[kMaxChainJoints], slope[kMaxChainJoints];
    Axis axes[kMaxChainJoints];
    Column columns[kMaxChainJoints];  // of the degrees of freedom
  };

  static HWY_INLINE Frame WalkCoupled(const FoldedCoupling& c, const V* x, CoupledJoints* all) {
    for (int i = 0; i < c.links.n; ++i) {
      const V at = hn::Sub(x[c.leader[i]], Number(c.from[i]));
      const double* p = c.polynomial[i];
      V value = Number(p[4]), slope = hn::Zero(d);
      for (int k = 3; k >= 0; --k) {
        slope = hn::MulAdd(slope, at, value);
        value = hn::MulAdd(value, at, Number(p[k]));
      }
      all->q[i] = value;
      all->slope[i] = hn::Mul(slope, Number(c.unit[i]));
    }
    return Walk<0>(c.links, all->q, all->axes);
  }

  // Adds the columns of the followers to those of their leaders.
  static HWY_INLINE void SumColumns(const FoldedCoupling& c, int n, const V3& tip,
                                    CoupledJoints* all) {
    const V3 none = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (int l = 0; l < n; ++l) all->columns[l] = {none, none};
    for (int i = 0; i < c.links.n; ++i) {
      const Column own = ColumnOf(c.links.joints[i], all->axes[i], tip);
      Column& sum = all->columns[c.leader[i]];
      sum.moves = MulAdd(all->slope[i], own.moves, sum.moves);
      sum.turns = MulAdd(all->slope[i], own.turns, sum.turns);
    }
  }

  template <int N, bool kTask, bool kRoams, bool kCoupled>
  static HWY_INLINE uint32_t StepGroup(const FoldedChain& chain, const LaneOptions& options,
                                       int lane, LaneState* state, const LaneTask* task) {
    constexpr int kMost = Moves<N, kTask>::kMost;
    const int n = N ? N : chain.n;
    V q[kMost];
    for (int i = 0; i < n; ++i) q[i] = Load(state->q[i] + lane);
    Axis axes[kMost];
    std::conditional_t<kCoupled, CoupledJoints, char> all;
    Frame f;
    if constexpr (kCoupled) {
      f = WalkCoupled(*chain.coupling, q, &all);
    } else {
      f = Walk<N>(chain, q, axes);
    }
    const double* to_tip = chain.tip.translation;
    const V3 tip = MulAdd(Number(to_tip[0]), f.x,
                          MulAdd(Number(to_tip[1]), f.y, MulAdd(Number(to_tip[2]), f.z, f.p)));
    const Residual residual = Measure<kTask>(f, tip, lane, task, *state);
    Note(residual, n, q, lane, state);
    const auto arrived = hn::And(hn::Le(residual.distance2, Number(options.distance2)),
                                 hn::Le(residual.turn2, Number(options.turn2)));
    auto stay = arrived;
    if constexpr (kTask) stay = hn::And(stay, hn::Le(residual.pull, hn::Zero(d)));

    Equations e;
    Moves<N, kTask> joints;
    const V roam = Load(state->roam + lane);
    if constexpr (kCoupled) {
      SumColumns(*chain.coupling, n, tip, &all);
      const auto column = [&](int i) HWY_ATTR { return all.columns[i]; };
      Assemble<kRoams>(chain, options, q, roam, column, lane, task, residual, &joints, &e);
    } else {
      const auto column = [&](int i) HWY_ATTR { return ColumnOf(chain.joints[i], axes[i], tip); };
      Assemble<kRoams>(chain, options, q, roam, column, lane, task, residual, &joints, &e);
    }
    SolveSix(hn::Set(d, 1.0), e.a, e.b);
    Advance<kRoams>(chain, options, q, roam, joints, e, stay, lane, state);
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, arrived, bits);
    return bits[0];
  }
};

using Wide = LaneStep<hn::CappedTag<double, kMaxLanes / kGroups>>;
// Kernel for fewer lanes: shorter registers wait less for their divisions, and on many processors
// the longest ones process half of their width at a time.
using Few = LaneStep<hn::CappedTag<double, kMostOfOneQuery>>;
using One = LaneStep<hn::CappedTag<double, 1>>;

int Count() { return kGroups * hn::Lanes(Wide::d); }
int CountOfOneQuery() { return hn::Lanes(Few::d); }

template <int N, bool kTask, bool kRoams, bool kCoupled = false>
uint32_t Step(const FoldedChain& chain, const LaneOptions& options, uint32_t busy, LaneState* state,
              const LaneTask* task) {
  if constexpr (!kTask) {
    if (busy == 1)
      return One::template StepGroup<N, kTask, kRoams, kCoupled>(chain, options, 0, state, task);
  }
  if (busy >> hn::Lanes(Few::d) == 0)
    return Few::template StepGroup<N, kTask, kRoams, kCoupled>(chain, options, 0, state, task);
  const int width = hn::Lanes(Wide::d);
  uint32_t arrived = 0;
  for (int first = 0; first < kGroups * width; first += width) {
    if ((busy >> first & ((1U << width) - 1)) != 0)
      arrived |= Wide::StepGroup<N, kTask, kRoams, kCoupled>(chain, options, first, state, task)
                 << first;
  }
  return arrived;
}

// Common numbers of joints have code of their own, whose arrays the compiler can lay out, for pose
// queries of chains in which no hinge spans a whole turn.
template <bool kTask, bool kRoams>
uint32_t StepFor(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                 LaneState* state, const LaneTask* task) {
  switch (chain.n) {
    case 6:
      return Step<6, kTask, kRoams>(chain, options, busy, state, task);
    case 7:
      return Step<7, kTask, kRoams>(chain, options, busy, state, task);
    default:
      return Step<0, kTask, true>(chain, options, busy, state, task);
  }
}

uint32_t StepAny(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                 LaneState* state, const LaneTask* task) {
  if (HWY_UNLIKELY(chain.coupling)) {
    return task ? Step<0, true, true, true>(chain, options, busy, state, task)
                : Step<0, false, true, true>(chain, options, busy, state, nullptr);
  }
  if (task) return StepFor<true, true>(chain, options, busy, state, task);
  return chain.has_whole_turns ? StepFor<false, true>(chain, options, busy, state, nullptr)
                               : StepFor<false, false>(chain, options, busy, state, nullptr);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace robocell::internal {

HWY_EXPORT(StepAny);
HWY_EXPORT(Count);
HWY_EXPORT(CountOfOneQuery);

int LaneCount() { return HWY_DYNAMIC_DISPATCH(Count)(); }
int LanesOfOneQuery() { return HWY_DYNAMIC_DISPATCH(CountOfOneQuery)(); }

uint32_t StepLanes(const FoldedChain& chain, const LaneOptions& options, uint32_t busy,
                   LaneState* state, const LaneTask* task) {
  return HWY_DYNAMIC_DISPATCH(StepAny)(chain, options, busy, state, task);
}

}  // namespace robocell::internal
#endif
