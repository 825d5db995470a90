#include "robocell/task/handle_motion.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "robocell/base/units.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/grasped_body.h"
#include "robocell/task/remembered_grasps.h"
#include "robocell/task/suction_grasps.h"

namespace robocell::internal {
namespace {

constexpr double kEntry = 0.03;          // m by which the fingers are wider than the bar
constexpr double kArcStep = 0.03;        // rad between poses of a path
constexpr double kLineStep = 0.005;      // m
constexpr double kBeforeHandle = 0.10;   // m, length of the way to a handle
constexpr double kOverButton = 0.05;     // m
constexpr double kPressFurther = 0.003;  // m beyond the end of the button's range
constexpr double kParallel = 0.9;        // cosine
constexpr double kMargin = 0.1;          // share by which an expert opens further than required
constexpr int kHandleSamples = 800, kMostHandleGrasps = 40;
constexpr int kPushSamples = 400, kMostPushes = 60;
constexpr int kMostCups = 160;
constexpr int kHookSamples = 2000, kMostHooks = 100;
constexpr double kBeforePush = 0.06;  // m, length of the way to a face that is pushed
constexpr double kAhead = 0.8;        // least cosine between a push and the motion
constexpr double kBehindBar = 0.005;  // m between the bar and a finger behind it
constexpr double kBeyondBar = 0.006;  // m by which its tip is beyond the middle of the bar
constexpr double kLean = 0.6;         // rad by which the hand leans along the bar
constexpr int kWayPoints = 4;         // of the way of a handle
constexpr int kSpins = 8;
constexpr int kRays = 24;

// Returns a geom as a bar, without `outward`; unset for planes and the like.
std::optional<HandleBar> BarOf(const mjModel* m, const mjData* d, int geom) {
  const Eigen::Map<const Eigen::Vector3d> middle(d->geom_xpos + 3 * geom);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(d->geom_xmat +
                                                                            9 * geom);
  const mjtNum* size = m->geom_size + 3 * geom;
  HandleBar bar{.middle = middle, .axis = axes.col(2), .outward = Eigen::Vector3d::Zero()};
  switch (m->geom_type[geom]) {
    case mjGEOM_CAPSULE:
    case mjGEOM_CYLINDER:
      bar.across = axes.col(0), bar.section.setConstant(size[0]), bar.half_length = size[1];
      return bar;
    case mjGEOM_SPHERE:
      bar.across = axes.col(0), bar.section.setConstant(size[0]);
      return bar;
    case mjGEOM_BOX:
    case mjGEOM_ELLIPSOID:
    case mjGEOM_MESH: {
      Eigen::Vector3d half(size[0], size[1], size[2]);
      if (m->geom_type[geom] == mjGEOM_MESH) {
        const mjtNum* box = m->geom_aabb + 6 * geom;  // middle and half sizes in the geom's frame
        bar.middle += axes * Eigen::Vector3d(box[0], box[1], box[2]);
        half = Eigen::Vector3d(box[3], box[4], box[5]);
        bar.is_exact = false;
      }
      Eigen::Index longest;
      half.maxCoeff(&longest);
      const Eigen::Index across = (longest + 1) % 3, other = (longest + 2) % 3;
      bar.axis = axes.col(longest), bar.half_length = half[longest];
      bar.across = axes.col(across), bar.section = Eigen::Vector2d(half[across], half[other]);
      bar.is_round = false;
      return bar;
    }
    default:
      return std::nullopt;
  }
}

Eigen::Vector3d AnyNormal(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d other =
      std::abs(axis.z()) < kParallel ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  return (other - other.dot(axis) * axis).normalized();
}

Pose Turned(const Eigen::Vector3d& anchor, const Eigen::Vector3d& axis, double angle) {
  return Pose(anchor) * Pose::FromRotvec({0, 0, 0}, angle * axis) * Pose(-anchor);
}

// The motion of a joint's body from its present position.
class JointMotion {
 public:
  JointMotion(const Scene& scene, const JointOpening& opening)
      : is_hinge_(scene.model()->jnt_type[opening.joint_id()] == mjJNT_HINGE),
        axis_(scene.data()->xaxis + 3 * opening.joint_id()),
        anchor_(scene.data()->xanchor + 3 * opening.joint_id()) {}
  Pose After(double way) const {
    return is_hinge_ ? Turned(anchor_, axis_, way) : Pose(way * axis_);
  }
  int Steps(double way, double radius) const {
    const double steps =
        is_hinge_ ? std::max(std::abs(way) / kArcStep, std::abs(way) * radius / (2 * kLineStep))
                  : std::abs(way) / kLineStep;
    return std::max(2, static_cast<int>(std::ceil(steps)));
  }
  bool is_hinge() const { return is_hinge_; }
  const Eigen::Vector3d& axis() const { return axis_; }
  // Returns the unit direction in which a point moves at first on a way.
  Eigen::Vector3d DirectionAt(const Eigen::Vector3d& point, double way) const {
    const Eigen::Vector3d ahead = is_hinge_ ? axis_.cross(point - anchor_) : axis_;
    return (way < 0 ? -1 : 1) * ahead.normalized();
  }
  // Returns the way of the joint that moves a point by a length.
  double WayOf(const Eigen::Vector3d& point, double length) const {
    return is_hinge_ ? length / std::max(RadiusOf(point), length) : length;
  }
  double RadiusOf(const Eigen::Vector3d& point) const {
    return (point - anchor_).cross(axis_).norm();
  }

 private:
  bool is_hinge_;
  Eigen::Vector3d axis_, anchor_;
};

std::string BodyOf(const Scene& scene, const JointOpening& opening) {
  return ElementName(scene.model(), mjOBJ_BODY, opening.body_id());
}

// Returns the paths of grasps of the joint's body, which move with it, best first. Cups and pushes
// have to face along the motion, where they turn a hinge those far from it need the least force, and
// hooks have to be behind the bar.
std::vector<ContactPath> PathsOfGrasps(const Scene& scene, const JointOpening& opening,
                                       const GripperShape& shape, double share,
                                       const GraspSet& grasps) {
  scene.SyncPoses();
  const mjData* d = scene.data();
  const int id = opening.body_id();
  const Pose body = Pose::FromTranslationAndMatrix(d->xpos + 3 * id, d->xmat + 9 * id);
  const JointMotion joint(scene, opening);
  const double way = opening.PositionAt(share) - opening.position();
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  struct Ranked {
    double lever;
    ContactPath path;
  };
  std::vector<Ranked> ranked;
  for (const Grasp& grasp : grasps.grasps) {
    const Pose start = body * grasp.tcp_in_body;
    const Eigen::Vector3d in = Rotate(body.quaternion(), grasp.approach);
    const Eigen::Vector3d in_tcp = Rotate(start.inverse().quaternion(), in);
    const bool hooks = grasp.kind == GraspKind::kHook;
    const bool pushes = grasp.kind == GraspKind::kPush || hooks;  // the hand stays closed
    const double gap = pushes ? GapOfClosedHand(shape) : grasp.width;
    const Eigen::Vector3d contact = start * shape.grasp_in_tcp() * shape.PadAt(gap);
    const Eigen::Vector3d moves = joint.DirectionAt(contact, way);
    bool grips = !pushes;
    double lever = 0;
    if (hooks) {
      // The hand is behind the bar, seen along the motion.
      if (!bar || bar->From(contact).dot(moves) > -kAhead) continue;
      lever = grasp.score;
    } else if (pushes || grasp.kind == GraspKind::kSuction) {
      const double ahead = in.dot(moves);
      if ((pushes ? ahead : std::abs(ahead)) < kAhead) continue;
      lever = joint.is_hinge() ? joint.RadiusOf(contact) : ahead;
      grips = ahead < 0;  // a cup that pushes need not stick
    }
    ContactPath path{.from = -in,
                     .before = grasp.approach_length,
                     .after = kBeforeHandle,
                     .free_gap = pushes ? gap : grasp.opening,
                     .contact_gap = gap,
                     .grips = grips};
    const int steps = joint.Steps(way, joint.RadiusOf(start.translation()));
    for (int i = 0; i <= steps; ++i)
      path.tcp_in_world.push_back(joint.After(way * i / steps) * start);
    path.away = -Rotate(path.tcp_in_world.back().quaternion(), in_tcp);
    ranked.push_back({lever, std::move(path)});
  }
  std::ranges::stable_sort(ranked, std::ranges::greater(), &Ranked::lever);
  std::vector<ContactPath> paths;
  for (Ranked& each : ranked) paths.push_back(std::move(each.path));
  return paths;
}

// The face of a button that slides, in the world.
struct Button {
  Eigen::Vector3d face;   // its middle
  Eigen::Matrix3d basis;  // z: the direction in which it is pressed
};
std::optional<Button> ButtonOf(const Scene& scene, const JointOpening& opening) {
  scene.SyncPoses();
  const JointMotion joint(scene, opening);
  if (joint.is_hinge()) return std::nullopt;
  const Eigen::Vector3d press = joint.axis() * (opening.open() > opening.closed() ? 1 : -1);
  Button button;
  button.basis.col(2) = press;
  button.basis.col(0) = AnyNormal(press);
  button.basis.col(1) = button.basis.col(2).cross(button.basis.col(0));
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  high = -low;
  for (const int geom : CollisionGeomsOf(scene.model(), opening.body_id())) {
    for (int i = 0; i < 3; ++i) {
      const Interval extent = GeomExtent(scene.model(), scene.data(), geom, button.basis.col(i));
      low[i] = std::min(low[i], extent.lower), high[i] = std::max(high[i], extent.upper);
    }
  }
  if (!low.allFinite()) return std::nullopt;
  button.face =
      button.basis * Eigen::Vector3d((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]);
  return button;
}

}  // namespace

double HandleBar::WidthAlong(const Eigen::Vector3d& direction) const {
  if (is_round) return 2 * section[0];
  return 2 * (section[0] * std::abs(direction.dot(across)) +
              section[1] * std::abs(direction.dot(axis.cross(across))));
}

Eigen::Vector3d HandleBar::From(const Eigen::Vector3d& point) const {
  const double along = std::clamp((point - middle).dot(axis), -half_length, half_length);
  return (point - middle - along * axis).normalized();
}

std::optional<HandleBar> FindHandle(const Scene& scene, const JointOpening& opening) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  std::optional<HandleBar> best;
  for (const int geom : FindGraspedBody(scene, BodyOf(scene, opening)).geoms) {
    if (!IsHandleGeom(scene, geom)) continue;
    const std::optional<HandleBar> bar = BarOf(m, d, geom);
    if (!bar) continue;
    const bool is_better =
        !best || bar->is_exact > best->is_exact ||
        (bar->is_exact == best->is_exact && bar->half_length > best->half_length);
    if (is_better) best = bar;
  }
  if (!best) return std::nullopt;
  // What carries the bar is what is nearest to it.
  std::vector<int> others;
  for (const int geom : CollisionGeomsOf(m, m->body_rootid[opening.body_id()])) {
    if (!IsHandleGeom(scene, geom)) others.push_back(geom);
  }
  const Eigen::Vector3d u = AnyNormal(best->axis), v = best->axis.cross(u);
  double nearest = std::numeric_limits<double>::infinity();
  best->outward = Eigen::Vector3d::UnitZ();
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2 * kPi * i / kRays;
    const Eigen::Vector3d direction = std::cos(angle) * u + std::sin(angle) * v;
    const RayHit hit = CastRay(m, d, others, best->middle, direction);
    if (hit.distance >= nearest - 1e-6) continue;
    nearest = hit.distance;
    best->outward = -direction;
  }
  return best;
}

bool TurnsOnTheSpot(const Scene& scene, const JointOpening& opening) {
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  const JointMotion joint(scene, opening);
  if (!bar || !joint.is_hinge()) return false;
  return joint.RadiusOf(bar->middle) < bar->section.maxCoeff();
}

std::optional<Eigen::Vector3d> FrontOf(const Scene& scene, const JointOpening& opening) {
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  Eigen::Vector3d front = Eigen::Vector3d::Zero();
  if (bar) {
    front = bar->outward;
  } else {
    const JointMotion joint(scene, opening);
    if (joint.is_hinge()) return std::nullopt;
    front = joint.axis() * (opening.open() > opening.closed() ? -1 : 1);
    if (front.head<2>().norm() < 0.5) return std::nullopt;  // pressed from above
  }
  if (front.head<2>().norm() < 0.5) {
    const int root = scene.model()->body_rootid[opening.body_id()];
    front = bar->middle - Eigen::Vector3d(scene.data()->xpos + 3 * root);
  }
  front.z() = 0;
  if (front.norm() < 1e-6) return std::nullopt;
  return front.normalized();
}

std::vector<Eigen::Vector3d> WayOfHandle(const Scene& scene, const JointOpening& opening,
                                         double share) {
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  const JointMotion joint(scene, opening);
  Eigen::Vector3d at;
  if (bar) {
    at = bar->middle;
  } else if (const auto button = ButtonOf(scene, opening)) {
    at = button->face;
  } else {
    return {};
  }
  const double way = opening.PositionAt(share) - opening.position();
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= kWayPoints; ++i) points.emplace_back(joint.After(way * i / kWayPoints) * at);
  return points;
}

std::vector<ContactPath> HandlePaths(const Scene& scene, const JointOpening& opening,
                                     const GripperShape& shape, double share, HandleHold hold) {
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  std::vector<ContactPath> paths;
  if (!bar || shape.is_suction()) return paths;
  const bool behind = hold == HandleHold::kBehind;
  const HeldWidths widths = WidthsHeld(shape.closed_gap(), shape.open_gap());
  const JointMotion joint(scene, opening);
  double way = opening.PositionAt(share) - opening.position();
  const double twist = joint.is_hinge() ? joint.axis().dot(bar->axis) : 0;
  const bool may_turn = std::abs(twist) > kParallel;
  const Pose tcp_in_grasp = shape.grasp_in_tcp().inverse();
  const Eigen::Vector3d moves = joint.DirectionAt(bar->middle, way);
  if (behind) {
    // The finger comes to the bar first.
    const double further = way + (way < 0 ? -1 : 1) * joint.WayOf(bar->middle, kBehindBar);
    const double low = std::min(opening.closed(), opening.open());
    const double high = std::max(opening.closed(), opening.open());
    way = std::clamp(opening.position() + further, low, high) - opening.position();
  }
  const int steps = joint.Steps(way, joint.RadiusOf(bar->middle));
  // Positive tilts come from above.
  const double up = bar->axis.cross(bar->outward).z() > 0 ? -1 : 1;

  // `from`: unit vector from the bar to the wrist; `across`: the closing direction.
  const auto add = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& across, double turn,
                       double along) {
    Eigen::Matrix3d axes;
    axes.col(2) = -from;
    axes.col(1) = across;
    axes.col(0) = axes.col(1).cross(axes.col(2));
    const double width = bar->WidthAlong(across);
    const Eigen::Vector3d at = bar->middle + along * bar->half_length * bar->axis;
    ContactPath path{.from = from,
                     .before = kBeforeHandle,
                     .after = kBeforeHandle,
                     .free_gap = std::min(shape.open_gap(), width + kEntry),
                     .contact_gap = width};
    Pose grasp(at - axes * shape.PadAt(width), axes);
    double aside = AsideFor(shape, width);
    if (behind) {
      const double ahead = moves.dot(across);
      const double room = shape.open_gap() / 2 - width / 2 - kBehindBar;
      if (std::abs(ahead) < kAhead || room < kBehindBar) return;
      path.grips = false;
      path.free_gap = path.contact_gap = shape.open_gap();
      // The tip reaches just beyond the middle of the bar: there may be little room behind it.
      Eigen::Vector3d hook = shape.PadAt(shape.open_gap());
      hook.z() = std::max(hook.z(), shape.TipAt(shape.open_gap()) - kBeyondBar);
      grasp = Pose(at - axes * hook + (ahead > 0 ? room : -room) * across, axes);
      aside = 0;
    } else if (width < widths.least || width > widths.most) {
      return;
    }
    // A finger that does not move must not touch the bar on the way to it.
    if (aside != 0) {
      path.tcp_in_world.push_back(Pose(-aside * across) * grasp * tcp_in_grasp);
      path.closed_at = 1;
    }
    for (int i = 0; i <= steps; ++i) {
      const double moved = way * i / steps;
      const Pose after = joint.After(moved);
      // The fingers turn about the bar by what the hand does not turn with the door.
      const Pose back = Turned(after * at, joint.axis(), turn < 1 ? -(1 - turn) * moved : 0);
      path.tcp_in_world.push_back(back * after * grasp * tcp_in_grasp);
    }
    path.away = -(path.tcp_in_world.back() * shape.grasp_in_tcp()).rotation().col(2);
    paths.push_back(std::move(path));
  };
  for (const double lean : {0.0, kLean, -kLean}) {
    for (const double tilt : {0.0, 0.4, -0.4, 0.8, -0.8, 1.3, -1.3}) {
      const Eigen::Vector3d level =
          Pose::FromRotvec({0, 0, 0}, up * tilt * bar->axis) * bar->outward;
      Eigen::Vector3d across = bar->axis.cross(level).normalized();
      // Positive leans come from above.
      if (across.cross(level).z() < 0) across = -across;
      const Eigen::Vector3d from = Pose::FromRotvec({0, 0, 0}, lean * across) * level;
      for (const double turn : {1.0, 0.5, 0.0}) {
        if (turn < 1 && !may_turn) continue;
        for (const double along : {0.0, 0.4, -0.4}) {
          if (lean != 0 && along != 0) continue;
          for (const double side : {1.0, -1.0}) add(from, side * across, turn, along);
        }
      }
    }
  }
  return paths;
}

std::vector<ContactPath> GraspedHandlePaths(const Robot& robot, const JointOpening& opening,
                                            const GripperShape& shape, double share) {
  const GraspKind kind = shape.is_suction() ? GraspKind::kSuction : GraspKind::kHandle;
  const GraspSet grasps =
      RememberedGrasps(robot, BodyOf(robot.scene(), opening),
                       {.kinds = {kind},
                        .samples = kHandleSamples,
                        .most = shape.is_suction() ? kMostCups : kMostHandleGrasps,
                        .approach_length = kBeforeHandle});
  return PathsOfGrasps(robot.scene(), opening, shape, share, grasps);
}

std::vector<ContactPath> PushedJointPaths(const Robot& robot, const JointOpening& opening,
                                          const GripperShape& shape, double share) {
  if (shape.is_suction()) return {};
  const GraspSet pushes = RememberedGrasps(robot, BodyOf(robot.scene(), opening),
                                           {.kinds = {GraspKind::kPush},
                                            .samples = kPushSamples,
                                            .most = kMostPushes,
                                            .approach_length = kBeforePush});
  return PathsOfGrasps(robot.scene(), opening, shape, share, pushes);
}

std::vector<ContactPath> HookedJointPaths(const Robot& robot, const JointOpening& opening,
                                          const GripperShape& shape, double share) {
  if (shape.is_suction()) return {};
  const GraspSet hooks = RememberedGrasps(robot, BodyOf(robot.scene(), opening),
                                          {.kinds = {GraspKind::kHook},
                                           .samples = kHookSamples,
                                           .most = kMostHooks,
                                           .approach_length = kBeforePush});
  return PathsOfGrasps(robot.scene(), opening, shape, share, hooks);
}

std::vector<ContactPath> PressPaths(const Scene& scene, const JointOpening& opening,
                                    const GripperShape& shape) {
  std::vector<ContactPath> paths;
  const std::optional<Button> button = ButtonOf(scene, opening);
  if (!button) return paths;
  const double way = opening.open() - opening.position();
  const Eigen::Vector3d press = button->basis.col(2);
  const double gap = GapOfClosedHand(shape);
  const Eigen::Vector3d pad = shape.PadAt(gap);
  const Eigen::Vector3d tip(pad.x(), pad.y(), std::max(shape.TipAt(gap), pad.z()));
  const double length = std::abs(way) + kPressFurther;
  const int steps = std::max(2, static_cast<int>(std::ceil(length / 0.002)));
  for (int spin = 0; spin < kSpins; ++spin) {
    const Eigen::Matrix3d axes =
        button->basis * Pose::FromRpy({0, 0, 0}, {0, 0, 2 * kPi * spin / kSpins}).rotation();
    ContactPath path{.from = -press,
                     .away = -press,
                     .before = kOverButton,
                     .after = kOverButton,
                     .free_gap = gap,
                     .contact_gap = gap};
    for (int i = 0; i <= steps; ++i) {
      const Pose grasp(button->face + length * i / steps * press - axes * tip, axes);
      path.tcp_in_world.push_back(grasp * shape.grasp_in_tcp().inverse());
    }
    paths.push_back(std::move(path));
  }
  return paths;
}

double ShareFor(const StatedRelation& stated) {
  const double share = stated.numbers.at(0);
  if (stated.relation == "closed") return std::max(0.0, share - kMargin);
  return std::min(1.0, share + kMargin);
}

ContactPathSource JointPaths(const Robot& robot, const StatedRelation& stated,
                             const GripperShape& shape, int failures) {
  using Way = std::function<std::vector<ContactPath>()>;
  const Scene scene = robot.scene();
  const JointOpening opening = JointOpening::Of(scene, stated.subject);
  const bool presses = stated.relation == "pressed";
  const double share = presses ? 1 : ShareFor(stated);
  const std::optional<HandleBar> bar = FindHandle(scene, opening);
  const bool has_bar = bar && bar->is_exact;
  const auto found = std::make_shared<bool>(false);  // some paths
  const Way press = [=, &shape] { return PressPaths(scene, opening, shape); };
  const Way grip = [=, &shape] {
    std::vector<ContactPath> paths;
    if (has_bar) paths = HandlePaths(scene, opening, shape, share);
    if (paths.empty() && (bar || shape.is_suction()))
      paths = GraspedHandlePaths(robot, opening, shape, share);
    return paths;
  };
  const Way reach_behind = [=, &shape] {
    return has_bar ? HandlePaths(scene, opening, shape, share, HandleHold::kBehind)
                   : std::vector<ContactPath>();
  };
  const Way hook = [=, &shape] {
    return bar && (failures > 0 || !*found) ? HookedJointPaths(robot, opening, shape, share)
                                            : std::vector<ContactPath>();
  };
  const Way push = [=, &shape] { return PushedJointPaths(robot, opening, shape, share); };
  const Way push_at_last = [=] { return *found ? std::vector<ContactPath>() : push(); };
  // After a failure the other ways come first, and then the same again.
  const bool again = failures % 2 == 1;
  std::vector<Way> ways;
  if (presses) {
    ways = {press};
  } else if (stated.relation == "closed") {
    ways = again ? std::vector<Way>{grip, reach_behind, hook, push}
                 : std::vector<Way>{push, reach_behind, hook, grip};
  } else {
    ways = again ? std::vector<Way>{reach_behind, hook, grip, push}
                 : std::vector<Way>{grip, reach_behind, hook, push_at_last};
  }
  return [ways = std::move(ways), found, next = size_t{0}]() mutable {
    std::vector<ContactPath> paths;
    while (paths.empty() && next < ways.size()) paths = ways[next++]();
    *found = *found || !paths.empty();
    return paths;
  };
}

std::string WhyNoJointPaths(const StatedRelation& stated) {
  return stated.relation == "pressed" ? "no way to press it" : "no grasp of the handle";
}

std::optional<Refusal> CheckJointGoal(const Scene& scene, const Robot& robot,
                                      const StatedRelation& stated) {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const JointOpening opening = JointOpening::Of(scene, stated.subject);
  PlanningScene planning(scene, robot, BodyOf(scene, opening), shape);
  const std::vector<double> home = robot.arm().joint_pos();
  ContactMotions motions(
      planning, {}, JointVector(std::span<const double>(home)),
      {.least_share = kLeastFollowed, .more = JointPaths(robot, stated, *shape)});
  if (motions.Next()) return std::nullopt;
  if (motions.paths().empty()) {
    std::string why;
    if (stated.relation == "pressed") {
      why = fmt::format(
          "joint '{}' is a hinge, or its body has no shape that collides; a button is "
          "pressed along its slide",
          opening.joint());
    } else if (shape->is_suction()) {
      why = WhyNothingSticks(*shape);
    } else if (FindHandle(scene, opening)) {
      why = "no part of the handle fits: the gripper " +
            DescribeHeldWidths(shape->closed_gap(), shape->open_gap());
    } else {
      why = fmt::format("joint '{}' moves no geom that is named handle or knob", opening.joint());
    }
    return Refusal{.reason = WhyNoJointPaths(stated), .detail = why, .holds_everywhere = true};
  }
  return Refusal{.reason = Refusal::kNoReachableBasePose, .detail = motions.Reasons()};
}

}  // namespace robocell::internal
