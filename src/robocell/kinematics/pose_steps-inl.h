// Transforms from the frame of one joint to those of its neighbours, for one configuration of a
// chain per lane. Included once for each instruction set, after pose_chain-inl.h.
//
// It uses the left-handed frames of pose_table.h, where cross products have the opposite sign. A
// value that is 0 for a chain is 0 in all lanes and all batches: leaving it out changes no result.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Reflects numbers along two axes: the mirror is at half the angle between the first axis and its
// image.
HWY_INLINE void Reflect(P cosine, P sine, P* a, P* b) {
  const P old = *a;
  *a = hn::MulAdd(cosine, old, hn::Mul(sine, *b));
  *b = hn::MulSub(sine, old, hn::Mul(cosine, *b));
}
// Reflects the axes themselves.
HWY_INLINE void Reflect(P cosine, P sine, Vec3<P>* a, Vec3<P>* b) {
  Reflect(cosine, sine, &a->x, &b->x);
  Reflect(cosine, sine, &a->y, &b->y);
  Reflect(cosine, sine, &a->z, &b->z);
}
// Reflects an inertia's numbers for two axes.
HWY_INLINE void Reflect(P cosine, P sine, P* aa, P* bb, P* ab) {
  const P more = hn::MulAdd(cosine, hn::Sub(*aa, *bb), hn::Mul(sine, hn::Add(*ab, *ab)));
  const P old = *aa;
  *aa = hn::MulAdd(cosine, more, *bb);
  *bb = hn::NegMulAdd(cosine, more, old);
  *ab = hn::MulSub(sine, more, *ab);
}

HWY_INLINE P Negated(P a) { return hn::Neg(a); }
HWY_INLINE Vec3<P> Negated(const Vec3<P>& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE void Swap(P* a, P* b) {
  const P old = *a;
  *a = *b;
  *b = old;
}
HWY_INLINE void Swap(Vec3<P>* a, Vec3<P>* b) {
  Swap(&a->x, &b->x);
  Swap(&a->y, &b->y);
  Swap(&a->z, &b->z);
}

// The transform and its inverse. Not for general twists.
template <class Step, class Number>
HWY_INLINE void Twist(const Step& step, Number* y, Number* z) {
  if (step.twist() == PoseJoint::Twist::kQuarter) {
    Swap(y, z);
  } else if (step.twist() == PoseJoint::Twist::kNone) {
    *y = Negated(*y);
  } else {
    Reflect(All(step.joint.twist_cosine), All(step.joint.twist_sine), z, y);
  }
}
template <class Step>
HWY_INLINE void Twist(const Step& step, Symmetric3<P>* m) {
  Twist(step, &m->xy, &m->xz);
  if (step.twist() == PoseJoint::Twist::kQuarter) {
    Swap(&m->yy, &m->zz);
  } else if (step.twist() == PoseJoint::Twist::kNone) {
    m->yz = hn::Neg(m->yz);
  } else {
    Reflect(All(step.joint.twist_cosine), All(step.joint.twist_sine), &m->zz, &m->yy, &m->yz);
  }
}
template <class Step>
HWY_INLINE bool IsAny(const Step& step) {
  return step.twist() == PoseJoint::Twist::kAny;
}
// Returns the twisted axes, without translation.
HWY_INLINE Frame3<P> AnyTwist(const PoseJoint& joint) {
  return {All(joint.rotation), All(joint.rotation + 3), All(joint.rotation + 6), ZeroVector()};
}

// Applies the joint's own motion.
template <class Step>
HWY_INLINE void MoveBy(const Step& step, const Move& move, Frame3<P>* f) {
  Reflect(move.cosine, move.sine, &f->x, &f->y);
  if (step.slide()) f->p = MulAdd(move.shift, f->z, f->p);
}

// Transforms to the frame of a joint from the previous one.
template <class Step>
HWY_INLINE void StepTo(const Step& step, const Move& move, Frame3<P>* f) {
  const PoseJoint& joint = step.joint;
  if (step.shifted(0)) f->p = MulAdd(All(joint.translation[0]), f->x, f->p);
  if (step.shifted(1)) f->p = MulAdd(All(joint.translation[1]), f->y, f->p);
  if (step.shifted(2)) f->p = MulAdd(All(joint.translation[2]), f->z, f->p);
  if (IsAny(step)) {
    const Frame3<P> before = *f, twisted = AnyTwist(joint);
    f->x = Turned(before, twisted.x);
    f->y = Turned(before, twisted.y);
    f->z = Turned(before, twisted.z);
  } else {
    Twist(step, &f->y, &f->z);
  }
  MoveBy(step, move, f);
}

// Calls visit(i, frame) for each joint, with frames relative to the table's origin; returns the
// last one.
template <class Chain, class Visit>
HWY_INLINE Frame3<P> WalkPoses(const Chain& chain, const JointMoves& moves, Visit&& visit) {
  Frame3<P> f = AnyTwist(chain[0].joint);
  MoveBy(chain[0], moves[0], &f);
  visit(0, f);
  chain.Up(1, chain.n() - 1, [&](int i) POSE_INLINE {
    StepTo(chain[i], moves[i], &f);
    visit(i, f);
  });
  return f;
}

// Transforms a vector to the frame of a joint from the previous one.
template <class Step>
HWY_INLINE void SeenFrom(const Step& step, const Move& move, Vec3<P>* v) {
  if (IsAny(step)) {
    const Frame3<P> twisted = AnyTwist(step.joint);
    *v = {Dot(twisted.x, *v), Dot(twisted.y, *v), Dot(twisted.z, *v)};
  } else {
    Twist(step, &v->y, &v->z);
  }
  Reflect(move.cosine, move.sine, &v->x, &v->y);
}

// Transforms values from the frame of a joint to the previous one.
template <class Step>
HWY_INLINE void Back(const Step& step, const Move& move, Vec3<P>* v) {
  Reflect(move.cosine, move.sine, &v->x, &v->y);
  if (IsAny(step)) {
    *v = Turned(AnyTwist(step.joint), *v);
  } else {
    Twist(step, &v->y, &v->z);
  }
}

// Adds the torque of a force at distance `s` along an axis, where a and b are the axes after it.
HWY_INLINE void AddLever(P s, P force_a, P force_b, P* torque_a, P* torque_b) {
  *torque_a = hn::MulAdd(s, force_b, *torque_a);
  *torque_b = hn::NegMulAdd(s, force_a, *torque_b);
}
template <class Step>
HWY_INLINE void Back(const Step& step, const Move& move, Six<P>* v) {
  Vec3<P>&force = v->linear, &torque = v->angular;
  if (step.slide()) AddLever(move.shift, force.x, force.y, &torque.x, &torque.y);
  Back(step, move, &force);
  Back(step, move, &torque);
  const double* s = step.joint.translation;
  if (step.shifted(0)) AddLever(All(s[0]), force.y, force.z, &torque.y, &torque.z);
  if (step.shifted(1)) AddLever(All(s[1]), force.z, force.x, &torque.z, &torque.x);
  if (step.shifted(2)) AddLever(All(s[2]), force.x, force.y, &torque.x, &torque.y);
}

// Moves a body's origin against an axis, k, by s; a and b are the other two.
template <class Step>
HWY_INLINE void Shift(const Step& step, P s, P* moment_k, P moment_a, P moment_b, P* aa, P* bb,
                      P* ka, P* kb) {
  P more = hn::Mul(s, hn::Add(*moment_k, *moment_k));
  if (step.heavy()) {
    const P moved = hn::Mul(s, All(step.joint.mass_behind));
    more = hn::MulAdd(s, moved, more);
    *moment_k = hn::Add(*moment_k, moved);
  }
  *aa = hn::Add(*aa, more);
  *bb = hn::Add(*bb, more);
  *ka = hn::NegMulAdd(s, moment_a, *ka);
  *kb = hn::NegMulAdd(s, moment_b, *kb);
}
template <class Step>
HWY_INLINE void ShiftX(const Step& step, P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(step, s, &h.x, h.y, h.z, &m.yy, &m.zz, &m.xy, &m.xz);
}
template <class Step>
HWY_INLINE void ShiftY(const Step& step, P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(step, s, &h.y, h.x, h.z, &m.xx, &m.zz, &m.xy, &m.yz);
}
template <class Step>
HWY_INLINE void ShiftZ(const Step& step, P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(step, s, &h.z, h.x, h.y, &m.xx, &m.yy, &m.xz, &m.yz);
}

// Computes the inertia of a joint's link and those behind it. The mass does not change.
template <class Step>
HWY_INLINE void Back(const Step& step, const Move& move, RigidBody<P>* body) {
  Symmetric3<P>& m = body->inertia;
  if (step.slide()) ShiftZ(step, move.shift, body);
  Reflect(move.cosine, move.sine, &m.xz, &m.yz);
  Reflect(move.cosine, move.sine, &m.xx, &m.yy, &m.xy);
  if (IsAny(step)) {
    m = Turned(AnyTwist(step.joint), m);
  } else {
    Twist(step, &m);
  }
  Back(step, move, &body->moment);
  const double* s = step.joint.translation;
  if (step.shifted(0)) ShiftX(step, All(s[0]), body);
  if (step.shifted(1)) ShiftY(step, All(s[1]), body);
  if (step.shifted(2)) ShiftZ(step, All(s[2]), body);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
