#include "robocell/robot/finger_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/servo_stability.h"
#include "robocell/scene/tool_elements.h"

namespace robocell::internal {
namespace {

constexpr int kPathParts = 40;
constexpr double kHardlyChanges = 0.05;  // share of the whole change of the distance
constexpr double kLongPart = 0.25;       // share of the path
constexpr double kOfTheMotion = 0.5;     // share of the middles' motion: less is near the hinges
constexpr double kNoChange = 1e-4;       // metres: the fingers do not move at all
constexpr double kDeep = 1e-3;           // metres; usual contacts give way by tenths of that
constexpr double kDepthWanted = 2.5e-4;  // metres

// The longest part of a path on which a distance hardly changes.
struct FlatPart {
  double share = 0;
  double distance = 0;
};

FlatPart LongestFlatPart(const std::vector<double>& distances) {
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  const double change = *most - *least;
  FlatPart longest;
  for (size_t i = 0; i < distances.size(); ++i) {
    double low = distances[i], high = distances[i];
    for (size_t k = i; k < distances.size(); ++k) {
      low = std::min(low, distances[k]);
      high = std::max(high, distances[k]);
      if (high - low >= kHardlyChanges * change) break;
      const double share = static_cast<double>(k - i) / kPathParts;
      if (share > longest.share) longest = {share, distances[i]};
    }
  }
  return longest;
}

class FingerPath {
 public:
  FingerPath(const mjModel* m, const FingerPair& pair, std::span<const double> from,
             std::span<const double> to)
      : m_(m),
        pair_(pair),
        from_(from),
        data_(MakeData(m)),
        displacement_(static_cast<size_t>(m->nv)) {
    mj_differentiatePos(m, displacement_.data(), 1, from.data(), to.data());
  }

  std::optional<FlatDistance> Run() {
    const std::vector<double> distances = Along(
        [this] { return FingerDistance(m_, data_.get(), pair_.fingers[0], pair_.fingers[1]); });
    const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
    if (*most - *least < kNoChange) return std::nullopt;
    const FlatPart flat = LongestFlatPart(distances);
    if (flat.share <= kLongPart) return std::nullopt;
    FlatDistance out{.distance = flat.distance, .share = flat.share};
    Place(distances.front() < distances.back() ? 0 : 1);
    const NearestPoints nearest = NearestOf(m_, data_.get(), pair_.fingers[0], pair_.fingers[1]);
    out.points = {Local(0, nearest.first), Local(1, nearest.second)};
    const std::vector<double> apart = Along([&] { return DistanceOf(out.points); });
    const auto [nearer, farther] = std::minmax_element(apart.begin(), apart.end());
    out.points_follow = LongestFlatPart(apart).share <= kLongPart &&
                        *farther - *nearer >= kOfTheMotion * MotionOfGeoms();
    return out;
  }

 private:
  void Place(double share) {
    mjData* d = data_.get();
    std::copy(from_.begin(), from_.end(), d->qpos);
    mj_integratePos(m_, d->qpos, displacement_.data(), share);
    Guarded("following the fingers", d, [&] { mj_kinematics(m_, d); });
  }

  template <class Measure>
  std::vector<double> Along(const Measure& measure) {
    std::vector<double> values;
    for (int i = 0; i <= kPathParts; ++i) {
      Place(static_cast<double>(i) / kPathParts);
      values.push_back(measure());
    }
    return values;
  }

  std::array<double, 3> Local(size_t finger, const mjtNum* point) const {
    return InFrameOf(pair_.fingers[finger].body, point);
  }

  std::array<double, 3> InFrameOf(int body, const mjtNum* point) const {
    std::array<double, 3> local{};
    mjtNum arm[3];
    mju_sub3(arm, point, data_->xpos + 3 * body);
    mju_mulMatTVec3(local.data(), data_->xmat + 9 * body, arm);
    return local;
  }

  // Returns the sum of the largest displacements of geoms of each finger in the hand's frame, m.
  double MotionOfGeoms() {
    double sum = 0;
    std::vector<std::array<double, 3>> centres;
    for (const double share : {0.0, 1.0}) {
      Place(share);
      size_t next = 0;
      for (const Finger& finger : pair_.fingers) {
        double most = 0;
        for (const int g : finger.geoms) {
          const std::array<double, 3> now = InFrameOf(pair_.hand, data_->geom_xpos + 3 * g);
          if (share == 0)
            centres.push_back(now);
          else
            most = std::max<double>(most, mju_dist3(now.data(), centres[next++].data()));
        }
        sum += most;
      }
    }
    return sum;
  }

  double DistanceOf(const std::array<std::array<double, 3>, 2>& points) const {
    mjtNum world[2][3];
    for (size_t i : {0, 1}) {
      const int body = pair_.fingers[i].body;
      mju_mulMatVec3(world[i], data_->xmat + 9 * body, points[i].data());
      mju_addTo3(world[i], data_->xpos + 3 * body);
    }
    return mju_dist3(world[0], world[1]);
  }

  const mjModel* m_;
  const FingerPair& pair_;
  std::span<const double> from_;
  const DataPtr data_;
  std::vector<mjtNum> displacement_;
};

std::string OwnName(const mjModel* m, const RobotRecord& robot, mjtObj kind, int id) {
  const std::string name = ElementName(m, kind, id);
  return name.starts_with(robot.prefix) ? name.substr(robot.prefix.size()) : name;
}

// Returns millimetres as metres without noise: "0.1", "-0.008".
std::string PointText(const std::array<double, 3>& point) {
  std::array<double, 3> rounded;
  for (size_t i = 0; i < 3; ++i) rounded[i] = std::round(point[i] * 1e4) / 1e4 + 0.0;
  return fmt::format("[{:g}]", fmt::join(rounded, ", "));
}

}  // namespace

std::optional<FlatDistance> FindFlatDistance(const mjModel* m, const FingerPair& pair,
                                             std::span<const double> from,
                                             std::span<const double> to) {
  return FingerPath(m, pair, from, to).Run();
}

std::string HowToFollow(const CompiledScene& scene, const RobotRecord& robot,
                        const FingerPair& pair, const FlatDistance& flat) {
  const mjModel* m = scene.model();
  std::array<std::string, 2> names;
  for (size_t i : {0, 1}) names[i] = OwnName(m, robot, mjOBJ_BODY, pair.fingers[i].body);
  std::string text = fmt::format(
      "the distance of '{}' and '{}' stays at {:.3g} m for {:.0f} % of their way, where other "
      "parts "
      "of them move, so openings say nothing there. Name as `fingers` the parts that grasp, geoms "
      "or sites",
      names[0], names[1], flat.distance, 100 * flat.share);
  if (!flat.points_follow) return text;
  std::array<SiteAdvice, 2> sites;
  for (size_t i : {0, 1}) {
    sites[i] = HowToAddSite(scene, robot, ElementName(m, mjOBJ_BODY, pair.fingers[i].body),
                            names[i] + "_tip", PointText(flat.points[i]));
  }
  if (sites[0].edit.empty() || sites[1].edit.empty())
    return text + fmt::format(" ({}; {})", sites[0].text, sites[1].text);
  return text + fmt::format(": fingers: [{{site: {}_tip}}, {{site: {}_tip}}] with edits: [{}, {}]",
                            names[0], names[1], sites[0].edit, sites[1].edit);
}

std::optional<PressedFingers> FindPressedFingers(const mjModel* m, const mjData* d,
                                                 const FingerPair& pair, double travel) {
  const auto half_thickness = [&](int geom) {
    const mjtNum* half = m->geom_aabb + 6 * geom + 3;
    return *std::min_element(half, half + 3);
  };
  const auto has = [&](int finger, int geom) {
    const std::vector<int>& geoms = pair.fingers[static_cast<size_t>(finger)].geoms;
    return std::find(geoms.begin(), geoms.end(), geom) != geoms.end();
  };
  std::optional<PressedFingers> deepest;
  double depth = kDeep;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (contact.exclude != 0 || -contact.dist <= depth) continue;
    const int a = contact.geom[0], b = contact.geom[1];
    if (!(has(0, a) && has(1, b)) && !(has(1, a) && has(0, b))) continue;
    const double crossed = std::min(half_thickness(a), half_thickness(b));
    if (-contact.dist <= std::min(kHardlyChanges * travel, crossed)) continue;
    depth = -contact.dist;
    deepest = PressedFingers{{a, b}, depth};
  }
  return m->opt.disableflags & mjDSBL_CONTACT ? std::nullopt : deepest;
}

std::string HowToPressLess(const mjModel* m, const RobotRecord& robot,
                           const PressedFingers& pressed, std::span<const int> actuators,
                           std::span<const double> pushed) {
  std::vector<std::string> edits;
  for (size_t i = 0; i < actuators.size(); ++i) {
    const double force = std::abs(pushed[i]) * kDepthWanted / pressed.depth;
    if (force <= 0) continue;
    edits.push_back(fmt::format("{{actuator: '{0}', forcerange: [-{1}, {1}]}}",
                                OwnName(m, robot, mjOBJ_ACTUATOR, actuators[i]),
                                RoundedGain(force)));
  }
  std::string text = fmt::format(
      "'{}' and '{}' press {:.2g} m into each other where the gripper is closed: its force is too "
      "large for their contact, so they are measured at 0 m, and meet late. ",
      OwnName(m, robot, mjOBJ_BODY, m->geom_bodyid[pressed.geoms[0]]),
      OwnName(m, robot, mjOBJ_BODY, m->geom_bodyid[pressed.geoms[1]]), pressed.depth);
  if (!edits.empty())
    text += fmt::format("Lower the force (edits: [{}]), or give", fmt::join(edits, ", "));
  else
    text += "Give";
  return text +
         fmt::format(" both a stiffer contact in the model (solref=\"{:g} 1\" of their geoms)",
                     2 * m->opt.timestep);
}

}  // namespace robocell::internal
