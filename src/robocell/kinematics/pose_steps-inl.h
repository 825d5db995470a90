// From the frame of one joint to those of its neighbours, for as many configurations of a chain as
// there are lanes. Included once for each instruction set, after lane_math-inl.h, link_math-inl.h
// and pose_rows-inl.h.
//
// Steps are short for a table in normal frames (normal_frames.h), and right for any. What is 0 for
// a chain is so in all lanes and all batches: leaving it out changes no result.
#include <hwy/highway.h>

#include "robocell/kinematics/link_table.h"

HWY_BEFORE_NAMESPACE();
namespace robocell::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE P All(double value) { return hn::Set(kPoses, value); }
HWY_INLINE Vec3<P> All(const double* v) { return {All(v[0]), All(v[1]), All(v[2])}; }
HWY_INLINE Vec3<P> All(const LinkTable::Row* rows, int i) {
  return {All(rows[0][i]), All(rows[1][i]), All(rows[2][i])};
}
HWY_INLINE Vec3<P> ZeroVector() { return {hn::Zero(kPoses), hn::Zero(kPoses), hn::Zero(kPoses)}; }

// What joint values do to the frames of joints.
class JointMoves {
 public:
  HWY_INLINE JointMoves(const LinkTable& t, const Inputs& q) {
    for (int i = 0; i < t.n; ++i) {
      const P off = hn::Sub(q[i], All(t.reference[i]));
      if (t.slides[i] != 0) {
        hn::Store(off, kPoses, shift_or_sine_[i]);
        continue;
      }
      P sine, cosine;
      SinCosOfAny(kPoses, off, &sine, &cosine);
      hn::Store(sine, kPoses, shift_or_sine_[i]);
      hn::Store(cosine, kPoses, cosine_[i]);
    }
  }

  HWY_INLINE P sine(int i) const { return hn::Load(kPoses, shift_or_sine_[i]); }
  HWY_INLINE P shift(int i) const { return hn::Load(kPoses, shift_or_sine_[i]); }
  HWY_INLINE P cosine(int i) const { return hn::Load(kPoses, cosine_[i]); }

 private:
  alignas(64) double shift_or_sine_[kMaxChainJoints][kWidth];
  alignas(64) double cosine_[kMaxChainJoints][kWidth];
};

// Numbers along two axes, seen from axes that are turned from the first towards the second.
HWY_INLINE void Turn(P cosine, P sine, P* a, P* b) {
  const P old = *a;
  *a = hn::MulAdd(cosine, old, hn::Mul(sine, *b));
  *b = hn::NegMulAdd(sine, old, hn::Mul(cosine, *b));
}
// By the twist of a step, which mostly is a quarter or nothing.
HWY_INLINE void Turn(double cosine, double sine, P* a, P* b) {
  if (cosine == 0 && sine == 1) {
    const P old = *a;
    *a = *b;
    *b = hn::Neg(old);
  } else if (cosine != 1) {
    Turn(All(cosine), All(sine), a, b);
  }
}
// The axes themselves.
template <class Number>
HWY_INLINE void Turn(Number cosine, Number sine, Vec3<P>* a, Vec3<P>* b) {
  Turn(cosine, sine, &a->x, &b->x);
  Turn(cosine, sine, &a->y, &b->y);
  Turn(cosine, sine, &a->z, &b->z);
}
// Back again.
HWY_INLINE void TurnBack(P cosine, P sine, P* a, P* b) { Turn(cosine, sine, b, a); }
HWY_INLINE void TurnBack(double cosine, double sine, P* a, P* b) { Turn(cosine, sine, b, a); }

// s * a + b
HWY_INLINE Vec3<P> Along(double s, const Vec3<P>& a, const Vec3<P>& b) {
  return s == 0 ? b : MulAdd(All(s), a, b);
}

// To the frame of joint i, from that before.
HWY_INLINE void StepTo(const LinkTable& t, int i, const JointMoves& moves, Frame3<P>* f) {
  if (i == 0) {
    *f = {All(t.rotation, 0), All(t.rotation + 3, 0), All(t.rotation + 6, 0), ZeroVector()};
  } else {
    f->p = Along(t.translation[0][i], f->x, f->p);
    f->p = Along(t.translation[1][i], f->y, f->p);
    f->p = Along(t.translation[2][i], f->z, f->p);
    if (t.twist[i]) {
      Turn(t.rotation[4][i], t.rotation[5][i], &f->y, &f->z);
    } else {
      const Frame3<P> before = *f;
      f->x = Turned(before, All(t.rotation, i));
      f->y = Turned(before, All(t.rotation + 3, i));
      f->z = Turned(before, All(t.rotation + 6, i));
    }
  }
  if (t.slides[i] != 0) {
    f->p = MulAdd(moves.shift(i), f->z, f->p);
  } else {
    Turn(moves.cosine(i), moves.sine(i), &f->x, &f->y);
  }
}

// Calls visit(i, frame) for each joint, the frames counted from the table's origin; the last one.
template <class Visit>
HWY_INLINE Frame3<P> WalkPoses(const LinkTable& t, const JointMoves& moves, Visit&& visit) {
  Frame3<P> f;
  for (int i = 0; i < t.n; ++i) {
    StepTo(t, i, moves, &f);
    visit(i, f);
  }
  return f;
}

// A vector in the frame of joint i, from that before.
HWY_INLINE Vec3<P> SeenFrom(const LinkTable& t, int i, const JointMoves& moves, Vec3<P> v) {
  if (t.twist[i]) {
    Turn(t.rotation[4][i], t.rotation[5][i], &v.y, &v.z);
  } else {
    v = {Dot(All(t.rotation, i), v), Dot(All(t.rotation + 3, i), v),
         Dot(All(t.rotation + 6, i), v)};
  }
  if (t.slides[i] == 0) Turn(moves.cosine(i), moves.sine(i), &v.x, &v.y);
  return v;
}

// What is known in the frame of joint i, in that before.
HWY_INLINE Vec3<P> Back(const LinkTable& t, int i, const JointMoves& moves, Vec3<P> v) {
  if (t.slides[i] == 0) TurnBack(moves.cosine(i), moves.sine(i), &v.x, &v.y);
  if (t.twist[i]) {
    TurnBack(t.rotation[4][i], t.rotation[5][i], &v.y, &v.z);
    return v;
  }
  return MulAdd(v.x, All(t.rotation, i),
                MulAdd(v.y, All(t.rotation + 3, i), Times(v.z, All(t.rotation + 6, i))));
}

// The torque of a force that is `s` away along an axis, a and b being the axes after it.
HWY_INLINE void AddLever(P s, P force_a, P force_b, P* torque_a, P* torque_b) {
  *torque_a = hn::NegMulAdd(s, force_b, *torque_a);
  *torque_b = hn::MulAdd(s, force_a, *torque_b);
}
HWY_INLINE void AddLever(double s, P force_a, P force_b, P* torque_a, P* torque_b) {
  if (s != 0) AddLever(All(s), force_a, force_b, torque_a, torque_b);
}
HWY_INLINE Six<P> Back(const LinkTable& t, int i, const JointMoves& moves, Six<P> v) {
  Vec3<P>&force = v.linear, &torque = v.angular;
  if (t.slides[i] != 0) AddLever(moves.shift(i), force.x, force.y, &torque.x, &torque.y);
  force = Back(t, i, moves, force);
  torque = Back(t, i, moves, torque);
  AddLever(t.translation[0][i], force.y, force.z, &torque.y, &torque.z);
  AddLever(t.translation[1][i], force.z, force.x, &torque.z, &torque.x);
  AddLever(t.translation[2][i], force.x, force.y, &torque.x, &torque.y);
  return v;
}

// A body about an origin that is moved against an axis, k, by s; a and b are the other two.
HWY_INLINE void Shift(P mass, P s, P* moment_k, P moment_a, P moment_b, P* aa, P* bb, P* ka,
                      P* kb) {
  const P moved = hn::MulAdd(mass, s, *moment_k);
  const P more = hn::Mul(s, hn::Add(*moment_k, moved));
  *moment_k = moved;
  *aa = hn::Add(*aa, more);
  *bb = hn::Add(*bb, more);
  *ka = hn::NegMulAdd(s, moment_a, *ka);
  *kb = hn::NegMulAdd(s, moment_b, *kb);
}
HWY_INLINE void ShiftX(P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(body->mass, s, &h.x, h.y, h.z, &m.yy, &m.zz, &m.xy, &m.xz);
}
HWY_INLINE void ShiftY(P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(body->mass, s, &h.y, h.x, h.z, &m.xx, &m.zz, &m.xy, &m.yz);
}
HWY_INLINE void ShiftZ(P s, RigidBody<P>* body) {
  Vec3<P>& h = body->moment;
  Symmetric3<P>& m = body->inertia;
  Shift(body->mass, s, &h.z, h.x, h.y, &m.xx, &m.yy, &m.xz, &m.yz);
}

// An inertia's numbers for two axes, as TurnBack does it with a vector's.
HWY_INLINE void TurnBack(P cosine, P sine, P* aa, P* bb, P* ab) {
  const P apart = hn::Sub(*aa, *bb), twice = hn::Add(*ab, *ab);
  const P more = hn::MulAdd(sine, apart, hn::Mul(cosine, twice));
  const P turned = hn::NegMulAdd(sine, twice, hn::Mul(cosine, apart));
  *aa = hn::NegMulAdd(sine, more, *aa);
  *bb = hn::MulAdd(sine, more, *bb);
  *ab = hn::MulAdd(sine, turned, *ab);
}
HWY_INLINE void TurnBack(double cosine, double sine, P* aa, P* bb, P* ab) {
  if (cosine == 0 && sine == 1) {
    const P old = *aa;
    *aa = *bb;
    *bb = old;
    *ab = hn::Neg(*ab);
  } else if (cosine != 1) {
    TurnBack(All(cosine), All(sine), aa, bb, ab);
  }
}

HWY_INLINE RigidBody<P> Back(const LinkTable& t, int i, const JointMoves& moves,
                             RigidBody<P> body) {
  Symmetric3<P>& m = body.inertia;
  if (t.slides[i] != 0) {
    ShiftZ(moves.shift(i), &body);
  } else {
    TurnBack(moves.cosine(i), moves.sine(i), &m.xz, &m.yz);
    TurnBack(moves.cosine(i), moves.sine(i), &m.xx, &m.yy, &m.xy);
  }
  if (t.twist[i]) {
    const double cosine = t.rotation[4][i], sine = t.rotation[5][i];
    TurnBack(cosine, sine, &m.xy, &m.xz);
    TurnBack(cosine, sine, &m.yy, &m.zz, &m.yz);
  } else {
    m = Turned(Frame3<P>{All(t.rotation, i), All(t.rotation + 3, i), All(t.rotation + 6, i), {}},
               m);
  }
  body.moment = Back(t, i, moves, body.moment);
  if (t.translation[0][i] != 0) ShiftX(All(t.translation[0][i]), &body);
  if (t.translation[1][i] != 0) ShiftY(All(t.translation[1][i]), &body);
  if (t.translation[2][i] != 0) ShiftZ(All(t.translation[2][i]), &body);
  return body;
}

}  // namespace robocell::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
