// Torques and mass matrices of one configuration per lane. Included once for each instruction set,
// after pose_steps-inl.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace robocell::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Vec3<P> Three(const Inputs& in) { return {in[0], in[1], in[2]}; }

// Works in the frames of the joints: gravity from the base outwards, the bodies behind a joint from
// the tip inwards.
template <class Chain>
HWY_NOINLINE void GravitiesOf(const Chain& chain, const JointMoves& moves, const Inputs& gravity,
                              double* out) {
  JointVectors g;
  Vec3<P> seen = Three(gravity);
  SeenFrom(AnyStep{chain[0].joint}, moves[0], &seen);
  g.Put(0, seen);
  chain.Up(1, chain.n() - 1, [&](int i) POSE_INLINE {
    SeenFrom(chain[i], moves[i], &seen);
    g.Put(i, seen);
  });
  Outputs<kMaxChainJoints> torques;
  Vec3<P> moment = ZeroVector();
  chain.Down(chain.n() - 1, 0, [&](int i) POSE_INLINE {
    const auto step = chain[i];
    const P mass = All(step.joint.weight_behind);
    moment = Add(moment, All(step.joint.weight_moment));
    const Vec3<P> pull = g[i];
    torques.Put(i, step.slide() ? hn::Neg(hn::Mul(mass, pull.z))
                                : hn::MulSub(moment.x, pull.y, hn::Mul(moment.y, pull.x)));
    if (i == 0) return;
    if (step.slide()) moment.z = hn::MulAdd(mass, moves[i].shift, moment.z);
    Back(step, moves[i], &moment);
    if (step.weighs()) moment = MulAdd(mass, All(step.joint.translation), moment);
  });
  torques.Write(chain.n(), out);
}

// Returns the base inertial parameters of a link.
HWY_INLINE RigidBody<P> LinkOf(const PoseJoint& joint) {
  return {All(joint.mass), All(joint.moment), AllOf(joint.inertia)};
}

// Adds another link, except for the mass.
template <class Step>
HWY_INLINE void Include(const Step& step, RigidBody<P>* sum) {
  Vec3<P>& h = sum->moment;
  Symmetric3<P>& m = sum->inertia;
  const double *moment = step.joint.moment, *inertia = step.joint.inertia;
  h.x = hn::Add(h.x, All(moment[0]));
  h.y = hn::Add(h.y, All(moment[1]));
  m.xx = hn::Add(m.xx, All(inertia[0]));
  m.zz = hn::Add(m.zz, All(inertia[2]));
  m.xy = hn::Add(m.xy, All(inertia[3]));
  m.xz = hn::Add(m.xz, All(inertia[4]));
  m.yz = hn::Add(m.yz, All(inertia[5]));
  if (!step.slide()) return;
  h.z = hn::Add(h.z, All(moment[2]));
  m.yy = hn::Add(m.yy, All(inertia[1]));
}

// Returns the momentum of a body that a joint moves with speed 1, in the joint's frame.
template <class Step>
HWY_INLINE Six<P> MomentumAlong(const Step& step, const RigidBody<P>& body) {
  const P zero = hn::Zero(kPoses);
  const Vec3<P>& h = body.moment;
  if (step.slide()) return {{zero, zero, All(step.joint.mass_behind)}, {hn::Neg(h.y), h.x, zero}};
  return {{h.y, hn::Neg(h.x), zero}, {body.inertia.xz, body.inertia.yz, body.inertia.zz}};
}

// Returns the component of momentum (or force), given in the joint's frame, along the joint's axis.
template <class Step>
HWY_INLINE P AlongJoint(const Step& step, const Six<P>& momentum) {
  return step.slide() ? momentum.linear.z : momentum.angular.z;
}

// Sums composite bodies in the frames of the joints, from the tip inwards; the momentum of each
// joint's motion is then transformed back to the previous joints (R. Featherstone, "Rigid Body
// Dynamics Algorithms", 2008, section 6.2).
template <class Chain>
HWY_NOINLINE void MassesOf(const Chain& chain, const JointMoves& moves, double* out) {
  const int n = chain.n();
  JointSixes momentum;
  RigidBody<P> behind = LinkOf(chain[n - 1].joint);
  chain.Down(n - 1, 1, [&](int i) POSE_INLINE {
    momentum.Put(i, MomentumAlong(chain[i], behind));
    Back(chain[i], moves[i], &behind);
    Include(chain[i - 1], &behind);
  });
  momentum.Put(0, MomentumAlong(chain[0], behind));

  Outputs<kMaxChainJoints * kMaxChainJoints> mass;
  chain.Down(n - 1, 0, [&](int j) POSE_INLINE {
    Six<P> carried = momentum[j];
    mass.Put(j * n + j, hn::Add(AlongJoint(chain[j], carried), All(chain[j].joint.armature)));
    chain.Down(j, 1, [&](int i) POSE_INLINE {
      Back(chain[i], moves[i], &carried);
      const P entry = AlongJoint(chain[i - 1], carried);
      mass.Put((i - 1) * n + j, entry);
      mass.Put(j * n + i - 1, entry);
    });
  });
  mass.Write(n * n, out);
}

template <class Step>
HWY_INLINE Six<P> UnitOf(const Step& step, const Frame3<P>& f) {
  if (step.slide()) return {f.z, ZeroVector()};
  return {Cross(f.p, f.z), f.z};
}

template <class Chain>
HWY_NOINLINE void MotionsOf(const Chain& chain, const JointMoves& moves, const Inputs& qd,
                            const Inputs& qdd, const Inputs& gravity, double* out) {
  JointSixes unit, force;
  const Six<P> none{ZeroVector(), ZeroVector()};
  Six<P> motion = none, change = none;
  const Vec3<P> g = Three(gravity);
  WalkPoses(chain, moves, [&](int i, const Frame3<P>& f) POSE_INLINE {
    const PoseJoint& joint = chain[i].joint;
    const Six<P> along = UnitOf(chain[i], f);
    const RigidBody<P> body = InParent(f, LinkOf(joint));
    motion = MulAdd(qd[i], along, motion);
    change = Add(change, MulAdd(qd[i], CarriedMotion(motion, along), Times(qdd[i], along)));
    Six<P> needed = Add(Momentum(body, change), CarriedForce(motion, Momentum(body, motion)));
    const P weight = All(joint.weight_mass);
    const Vec3<P> moment = MulAdd(weight, f.p, Turned(f, All(joint.weight_moment)));
    needed.linear = MulAdd(hn::Neg(weight), g, needed.linear);
    needed.angular = Sub(needed.angular, Cross(moment, g));
    unit.Put(i, along);
    force.Put(i, needed);
  });
  Outputs<kMaxChainJoints> torques;
  Six<P> sum = none;
  chain.Down(chain.n() - 1, 0, [&](int i) POSE_INLINE {
    sum = Add(sum, force[i]);
    torques.Put(i, hn::MulAdd(All(chain[i].joint.armature), qdd[i], Dot(unit[i], sum)));
  });
  torques.Write(chain.n(), out);
}

}  // namespace robocell::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
