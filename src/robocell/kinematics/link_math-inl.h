// Vectors, rotations and rigid bodies with one lane each for many links, or for many poses of one
// link. Included once for each instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Vec3 {
  V x, y, z;
};

template <class V>
HWY_INLINE Vec3<V> Add(const Vec3<V>& a, const Vec3<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3<V> Sub(const Vec3<V>& a, const Vec3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3<V> Times(V s, const Vec3<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
// s * a + b
template <class V>
HWY_INLINE Vec3<V> MulAdd(V s, const Vec3<V>& a, const Vec3<V>& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}
template <class V>
HWY_INLINE V Dot(const Vec3<V>& a, const Vec3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
template <class V>
HWY_INLINE Vec3<V> Cross(const Vec3<V>& a, const Vec3<V>& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

// Axes and origin of a frame.
template <class V>
struct Frame3 {
  Vec3<V> x, y, z, p;
};

// Rotates from the frame's axes to those of its parent.
template <class V>
HWY_INLINE Vec3<V> Turned(const Frame3<V>& f, const Vec3<V>& v) {
  return MulAdd(v.x, f.x, MulAdd(v.y, f.y, Times(v.z, f.z)));
}

// A force with a torque, or a velocity of the origin with an angular velocity.
template <class V>
struct Six {
  Vec3<V> linear, angular;
};
template <class V>
HWY_INLINE Six<V> Add(const Six<V>& a, const Six<V>& b) {
  return {Add(a.linear, b.linear), Add(a.angular, b.angular)};
}
template <class V>
HWY_INLINE Six<V> MulAdd(V s, const Six<V>& a, const Six<V>& b) {
  return {MulAdd(s, a.linear, b.linear), MulAdd(s, a.angular, b.angular)};
}
template <class V>
HWY_INLINE Six<V> Times(V s, const Six<V>& a) {
  return {Times(s, a.linear), Times(s, a.angular)};
}
template <class V>
HWY_INLINE V Dot(const Six<V>& a, const Six<V>& b) {
  return hn::Add(Dot(a.linear, b.linear), Dot(a.angular, b.angular));
}
// Returns the change of a motion that is carried along by another one.
template <class V>
HWY_INLINE Six<V> CarriedMotion(const Six<V>& by, const Six<V>& motion) {
  return {Add(Cross(by.angular, motion.linear), Cross(by.linear, motion.angular)),
          Cross(by.angular, motion.angular)};
}
// Returns the change of a momentum that is carried along by a motion.
template <class V>
HWY_INLINE Six<V> CarriedForce(const Six<V>& by, const Six<V>& force) {
  return {Cross(by.angular, force.linear),
          Add(Cross(by.angular, force.angular), Cross(by.linear, force.linear))};
}

// Returns a joint's unit motion: about the axis for a hinge, along it for a slide. One of `turns`
// and `slides` is 1, the other 0.
template <class V>
HWY_INLINE Six<V> UnitMotion(V turns, V slides, const Frame3<V>& f) {
  const Vec3<V> axis = Times(turns, f.z);
  return {Add(Cross(f.p, axis), Times(slides, f.z)), axis};
}

// The diagonal and the upper triangle.
template <class V>
struct Symmetric3 {
  V xx, yy, zz, xy, xz, yz;
};
template <class V>
HWY_INLINE Vec3<V> Times(const Symmetric3<V>& s, const Vec3<V>& v) {
  return {hn::MulAdd(s.xx, v.x, hn::MulAdd(s.xy, v.y, hn::Mul(s.xz, v.z))),
          hn::MulAdd(s.xy, v.x, hn::MulAdd(s.yy, v.y, hn::Mul(s.yz, v.z))),
          hn::MulAdd(s.xz, v.x, hn::MulAdd(s.yz, v.y, hn::Mul(s.zz, v.z)))};
}

// Mass, mass * centre of mass, and inertia about an origin.
template <class V>
struct RigidBody {
  V mass;
  Vec3<V> moment;
  Symmetric3<V> inertia;
};

// R * inertia * R^T
template <class V>
HWY_INLINE Symmetric3<V> Turned(const Frame3<V>& f, const Symmetric3<V>& s) {
  const Vec3<V> a = Turned(f, Vec3<V>{s.xx, s.xy, s.xz});
  const Vec3<V> b = Turned(f, Vec3<V>{s.xy, s.yy, s.yz});
  const Vec3<V> c = Turned(f, Vec3<V>{s.xz, s.yz, s.zz});
  const auto at = [&](V ra, V rb, V rc, V x, V y, V z)
                      HWY_ATTR { return hn::MulAdd(ra, x, hn::MulAdd(rb, y, hn::Mul(rc, z))); };
  return {at(a.x, b.x, c.x, f.x.x, f.y.x, f.z.x), at(a.y, b.y, c.y, f.x.y, f.y.y, f.z.y),
          at(a.z, b.z, c.z, f.x.z, f.y.z, f.z.z), at(a.x, b.x, c.x, f.x.y, f.y.y, f.z.y),
          at(a.x, b.x, c.x, f.x.z, f.y.z, f.z.z), at(a.y, b.y, c.y, f.x.z, f.y.z, f.z.z)};
}

// Returns a body, given in a frame, in the axes and about the origin of the frame's parent.
template <class V>
HWY_INLINE RigidBody<V> InParent(const Frame3<V>& f, const RigidBody<V>& body) {
  const Vec3<V> h = Turned(f, body.moment);
  const Vec3<V> moment = MulAdd(body.mass, f.p, h);
  Symmetric3<V> i = Turned(f, body.inertia);
  const V trace = hn::Add(Dot(h, f.p), Dot(moment, f.p));
  const auto less = [&](V from, V m, V p, V q, V k)
                        HWY_ATTR { return hn::NegMulAdd(m, p, hn::NegMulAdd(q, k, from)); };
  i.xx = less(hn::Add(i.xx, trace), moment.x, f.p.x, f.p.x, h.x);
  i.yy = less(hn::Add(i.yy, trace), moment.y, f.p.y, f.p.y, h.y);
  i.zz = less(hn::Add(i.zz, trace), moment.z, f.p.z, f.p.z, h.z);
  i.xy = less(i.xy, moment.x, f.p.y, f.p.x, h.y);
  i.xz = less(i.xz, moment.x, f.p.z, f.p.x, h.z);
  i.yz = less(i.yz, moment.y, f.p.z, f.p.y, h.z);
  return {body.mass, moment, i};
}

// Returns the momentum of a body in motion, and the force that accelerates it.
template <class V>
HWY_INLINE Six<V> Momentum(const RigidBody<V>& body, const Six<V>& motion) {
  return {MulAdd(body.mass, motion.linear, Cross(motion.angular, body.moment)),
          Add(Times(body.inertia, motion.angular), Cross(body.moment, motion.linear))};
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
