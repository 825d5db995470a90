#include "robocell/task/held_tasks.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/hollows.h"
#include "robocell/scenes/place_overlap.h"
#include "robocell/spec/validate.h"
#include "robocell/task/colours.h"
#include "robocell/task/drawn_objects.h"
#include "robocell/task/held.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/pouring.h"
#include "robocell/task/wiping.h"

namespace robocell::internal {
namespace {

constexpr const char* kHole = "hole";
constexpr const char* kArea = "area";
constexpr const char* kSponge = "sponge";
constexpr const char* kReceiver = "receiver";  // the object, and its default kind
constexpr const char* kSquare = "square";
constexpr const char* kRound = "round";
constexpr const char* kPlug = "plug";
constexpr double kPegLength = 0.11;  // m
constexpr double kPlateHalf = 0.05, kPlateHalfHeight = 0.004;
constexpr double kAreaHalfX = 0.08, kAreaHalfY = 0.06;  // m, of models/equipment/wiping_area
constexpr int kAreaDraws = 16;                          // places of the area that are tried

template <class Config>
const Config& Checked(const Config& fields) {
  RequireValid(fields, fmt::format("task '{}'", Config::kKind));
  return fields;
}

std::string StemOf(const SceneObject& object) {
  if (object.shape) return std::string(ToString(*object.shape));
  return std::filesystem::path(object.mjcf_path).stem().string();
}

std::string StemInScene(const Scene& scene, const std::string& name) {
  for (const SceneObject& object : scene.spec().objects) {
    if (object.name == name) return StemOf(object);
  }
  return name;
}

std::string WordsFrom(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

Feature Share(const std::string& name, const std::string& description) {
  return {.column = {.name = name,
                     .shape = {1},
                     .units = "1",
                     .frame = "",
                     .names = {name},
                     .description = description},
          .role = FeatureRole::kPrivileged,
          .lower = {0},
          .upper = {1}};
}

// Returns places in the frame of a vessel, in layers with a hexagonal grid; none if not all fit.
std::vector<Eigen::Vector3d> GrainPlaces(const Vessel& vessel, int count, double radius) {
  const double spacing = 2.02 * radius;
  // Tiny grains do not need the whole width.
  const double room = std::min(vessel.radius() - radius, spacing * std::sqrt(count));
  std::vector<Eigen::Vector2d> layer;
  const int most = room > 0 ? static_cast<int>(room / spacing) + 1 : 0;
  for (int i = -2 * most; i <= 2 * most; ++i) {
    for (int j = -2 * most; j <= 2 * most; ++j) {
      const Eigen::Vector2d at(spacing * (i + 0.5 * j), spacing * j * std::sqrt(0.75));
      if (at.norm() <= room + 1e-9) layer.push_back(at);
    }
  }
  const Eigen::Vector3d bottom = vessel.bottom();
  const double layers = std::floor((vessel.mouth().z() - bottom.z()) / spacing);
  std::vector<Eigen::Vector3d> places;
  if (static_cast<double>(layer.size()) * layers < count) return places;
  for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
    const Eigen::Vector2d& at = layer[i % layer.size()];
    const size_t layers_below = i / layer.size();
    const double up = spacing * (static_cast<double>(layers_below) + 0.5);
    places.push_back(bottom + Eigen::Vector3d(at.x(), at.y(), up));
  }
  return places;
}

std::string DoNotFit(const Vessel& vessel, const std::string& kind, const PourTaskConfig& task) {
  return fmt::format(
      "{} grains with a radius of {:g} m do not fit into the {}, {:.3f} m wide and {:.3f} m deep; "
      "lower task.grains or task.grain_radius",
      task.grains, task.grain_radius, kind, 2 * vessel.radius(),
      vessel.mouth().z() - vessel.bottom().z());
}

// Returns a scene with one object, the target.
Scene SceneWith(const std::string& kind) {
  Rng rng = Rng::Stream(0, "check");
  SceneSpec spec{.name = kind, .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.objects.push_back(PickAndPlaceTask::MakeGoalObject(kind, kTarget, rng));
  spec.objects[0].pos = Vec3{};
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  return scene;
}

// Returns why the target cannot be poured from or into; "" if it can.
std::string WhyNoVessel(const Scene& scene, const std::string& kind) {
  const ObjectRecord& target = scene.compiled()->object(kTarget);
  const std::optional<Hollow> hollow =
      FindHollow(scene, FindId(scene.model(), mjOBJ_BODY, target.root_body));
  if (hollow && hollow->opening.z() > 0.5) return "";
  return fmt::format(
      "'{}' has no hollow that is open upwards, which a vessel needs; name a kind "
      "such as {} or {}",
      kind, PourTask::kDefaultVessel, kReceiver);
}

}  // namespace

InsertTask::InsertTask(const InsertTaskConfig& fields) : task_(Checked(fields)) {}

std::vector<std::string> InsertTask::AllShapes() { return {kSquare, kRound, kPlug}; }

SceneObject InsertTask::MakePeg(const std::string& shape, const std::string& name,
                                double clearance) {
  if (shape == kPlug) return {.name = name, .mjcf_path = kPlug, .fixed = false};
  const double half = (kHoleWidth - clearance) / 2;
  const bool is_round = shape == kRound;
  return {.name = name,
          .shape = is_round ? Shape::kCylinder : Shape::kBox,
          .size = is_round ? Vec3{half, kPegLength / 2, 0} : Vec3{half, half, kPegLength / 2},
          .rgba = kNamedColours[is_round ? 1 : 0].rgba,
          .mass = 0.08,
          .friction = Vec3{1, 0.02, 0.001},
          .condim = Condim::kTorsional};
}

void InsertTask::AddObjects(SceneSpec& spec, Rng& rng) {
  const std::vector<std::string> shapes = task_.shapes.empty() ? AllShapes() : task_.shapes.names;
  const std::string shape =
      is_prepared_once() ? shapes[rng.UniformInt(shapes.size())] : turn().Choose(shapes);
  const bool is_plug = shape == kPlug;
  spec.objects.push_back(MakePeg(shape, kTarget, task_.clearance));
  Name(kTarget, is_plug ? kPlug : shape + "_peg");
  const std::string hole = is_plug ? "socket" : shape + "_hole";
  spec.objects.push_back({.name = kHole, .mjcf_path = hole, .fixed = false});
  Name(kHole, hole);
}

void InsertTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kHole}) scene.compiled()->object(name);
  const std::string hole = StemInScene(scene, kHole);
  Name(kTarget, hole == "socket" ? kPlug : hole.substr(0, hole.find('_')) + "_peg");
  Name(kHole, hole);
}

std::vector<std::string> InsertTask::StatedGoal() const {
  return {fmt::format("{} inserted {} {}", kTarget, kHole, task_.depth)};
}

std::string InsertTask::WordFor(const std::string& name) const { return WordsFrom(kind_of(name)); }

std::vector<Feature> InsertTask::signals() const {
  return {Share("insertion", "Half for being over the hole, and half for the depth in it.")};
}

void InsertTask::Observe(const Scene& /*scene*/, std::span<double> out) const {
  out[0] = goals().empty() ? 0 : goals().front().bound->Progress();
}

SortTask::SortTask(const SortTaskConfig& fields) : task_(Checked(fields)) {}

void SortTask::AddObjects(SceneSpec& spec, Rng& /*rng*/) {
  const double half = task_.edge / 2;
  for (const bool is_plate : {false, true}) {
    for (int i = 0; i < task_.objects; ++i) {
      const NamedColour& colour = kNamedColours[static_cast<size_t>(i)];
      const char* kind = is_plate ? "plate" : "cube";
      spec.objects.push_back({.name = fmt::format("{}_{}", colour.word, kind),
                              .shape = Shape::kBox,
                              .size = is_plate ? Vec3{kPlateHalf, kPlateHalf, kPlateHalfHeight}
                                               : Vec3{half, half, half},
                              .rgba = colour.rgba,
                              .mass = is_plate ? 0.3 : 1000 * std::pow(task_.edge, 3),
                              .friction = Vec3{1, 0.02, 0.001},
                              .condim = Condim::kTorsional});
      Name(spec.objects[spec.objects.size() - 1].name, kind);
    }
  }
}

void SortTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* kind : {"cube", "plate"}) {
    for (int i = 0; i < task_.objects; ++i) {
      const std::string name =
          fmt::format("{}_{}", kNamedColours[static_cast<size_t>(i)].word, kind);
      scene.compiled()->object(name);  // NotFoundError with the names
      Name(name, kind);
    }
  }
}

std::vector<std::string> SortTask::StatedGoal() const {
  std::vector<std::string> goal;
  for (int i = 0; i < task_.objects; ++i)
    goal.push_back(
        fmt::format("{0}_cube on {0}_plate", kNamedColours[static_cast<size_t>(i)].word));
  return goal;
}

std::string SortTask::WordFor(const std::string& name) const { return WordsFrom(name); }

std::optional<Refusal> SortTask::CheckStart(const Scene& scene) {
  if (auto refusal = RelationTask::CheckStart(scene)) return refusal;
  for (const Goal& goal : goals()) {
    if (goal.bound->Holds()) continue;
    if (auto refusal = CheckGoal(scene, goal)) return refusal;
  }
  return std::nullopt;
}

WipeTask::WipeTask(const WipeTaskConfig& fields) : RelationTask(0.1), task_(Checked(fields)) {}

int WipeTask::CellCount() {
  return static_cast<int>(std::lround(2 * kAreaHalfX / kWipeCell) *
                          std::lround(2 * kAreaHalfY / kWipeCell));
}

void WipeTask::AddObjects(SceneSpec& spec, Rng& /*rng*/) {
  spec.objects.push_back({.name = kTarget,
                          .shape = Shape::kBox,
                          .size = Vec3{0.035, 0.022, 0.025},
                          .rgba = kNamedColours[3].rgba,
                          .mass = 0.05,
                          .friction = Vec3{0.7, 0.02, 0.001},
                          .condim = Condim::kTorsional});
  Name(kTarget, kSponge);
  spec.objects.push_back({.name = kArea, .mjcf_path = "wiping_area", .pos = Vec3{}});
  Name(kArea, kArea);
}

void WipeTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kArea}) scene.compiled()->object(name);
  const size_t cells = WipeRegion(scene, kArea).cells().size();
  if (cells != static_cast<size_t>(CellCount()))
    throw ArgumentError(
        fmt::format("{}: '{}' has {} cells of {:g} m, and the task records {}: make it {:g} x {:g} "
                    "m large, or state the goal \"{} wiped {}\" with `kind: relations`",
                    place(), kArea, cells, kWipeCell, CellCount(), 2 * kAreaHalfX, 2 * kAreaHalfY,
                    kTarget, kArea));
  sponge_.emplace(scene, scene.compiled()->object(kTarget).root_body);
  Name(kTarget, kSponge);
  Name(kArea, kArea);
}

std::vector<std::string> WipeTask::StatedGoal() const {
  return {fmt::format("{} wiped {} {}", kTarget, kArea, task_.share)};
}

std::string WipeTask::WordFor(const std::string& name) const {
  return name == kArea ? "marked area" : "";
}

// The area lies beside the sponge, on what the sponge stands on.
std::optional<Refusal> WipeTask::Draw(Scene& scene, Rng& rng) {
  const mjModel* m = scene.model();
  const ObjectRecord& target = scene.compiled()->object(kTarget);
  const int body = FindId(m, mjOBJ_BODY, target.root_body);
  const Eigen::Vector3d at = scene.body_pose(target.root_body).translation();
  const double low = BodyExtent(m, scene.data(), body, Eigen::Vector3d::UnitZ()).lower;
  std::vector<int> others;
  for (int geom = 0; geom < m->ngeom; ++geom) {
    if (IsCollisionGeom(m, geom) && !IsInSubtree(m, m->geom_bodyid[geom], body))
      others.push_back(geom);
  }
  const WipeRegion region(scene, kArea);
  const auto has_support = [&](const Pose& area) {
    constexpr double kOver = 0.02, kOff = 0.01;  // m
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j) {
        const Eigen::Vector3d above =
            area * Eigen::Vector3d(i * (region.half_x() + 0.02) / 2,
                                   j * (region.half_y() + 0.02) / 2, kOver);
        const double distance =
            CastRay(m, scene.data(), others, above, -Eigen::Vector3d::UnitZ()).distance;
        if (!(std::abs(distance - kOver) < kOff)) return false;
      }
    }
    return true;
  };
  // The sponge, side by side over the whole area and a little beyond it, meets nothing, however thin.
  PlaceOverlap overlap(scene, body);
  const Pose sponge = scene.body_pose(target.root_body);
  Eigen::Vector2d half = Eigen::Vector2d::Zero();
  for (const int axis : {0, 1}) {
    const Interval extent = BodyExtent(m, scene.data(), body, sponge.rotation().col(axis));
    half[axis] = (extent.upper - extent.lower) / 2;
  }
  const auto is_free = [&](const Pose& area) {
    constexpr double kLift = 0.002;  // m over the support
    if (!has_support(area)) return false;
    const int columns = static_cast<int>(std::ceil(region.half_x() / half.x()));
    const int rows = static_cast<int>(std::ceil(region.half_y() / half.y()));
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const Eigen::Vector3d place((2 * i + 1 - columns) * half.x(), (2 * j + 1 - rows) * half.y(),
                                    sponge.translation().z() - low + kLift);
        if (!overlap.IsFree(Pose((area * place).eval(), area.quaternion()), 0)) return false;
      }
    }
    return true;
  };
  for (int i = 0; i < kAreaDraws; ++i) {
    const double angle = rng.Uniform(-kPi, kPi);
    const double distance = rng.Uniform(task_.distance[0], task_.distance[1]);
    const Eigen::Vector3d middle(at.x() + distance * std::cos(angle),
                                 at.y() + distance * std::sin(angle), low + 0.001);
    const Pose area = Pose::FromRpy(middle, {0, 0, rng.Uniform(-kPi, kPi)});
    if (!is_free(area)) continue;
    scene.SetBodyPose(scene.compiled()->object(kArea).root_body, area);
    return std::nullopt;
  }
  return Refusal{.reason = "no free place for the area",
                 .detail = "beside the sponge its support ends, or something is in the way"};
}

std::vector<Feature> WipeTask::signals() const {
  Feature cells{
      .column = {.name = "wiped",
                 .shape = {CellCount()},
                 .units = "1",
                 .frame = "",
                 .names = {},
                 .description = "1 for each cell of the area that has been wiped, else 0."},
      .role = FeatureRole::kPrivileged,
      .lower = std::vector<double>(static_cast<size_t>(CellCount()), 0),
      .upper = std::vector<double>(static_cast<size_t>(CellCount()), 1)};
  for (int i = 0; i < CellCount(); ++i) cells.column.names.push_back(fmt::format("cell_{}", i));
  Feature force{.column = {.name = "wiping_force",
                           .shape = {1},
                           .units = "N",
                           .frame = "",
                           .names = {"wiping_force"},
                           .description = "Force between the sponge and all that is no robot."},
                .role = FeatureRole::kPrivileged,
                .lower = {0},
                .upper = {1000}};
  return {cells, force};
}

void WipeTask::Observe(const Scene& scene, std::span<double> out) const {
  std::ranges::fill(out, 0);
  if (goals().empty()) return;
  const std::vector<double> cells = goals().front().bound->memory();
  std::copy_n(cells.begin(), std::min(cells.size(), out.size() - 1), out.begin());
  out[out.size() - 1] = std::min(1000.0, ForceOnOthers(scene, sponge_->id()));
}

PourTask::PourTask(const PourTaskConfig& fields) : task_(Checked(fields)) {}

void PourTask::AddObjects(SceneSpec& spec, Rng& rng) {
  const auto draw = [&](const NameList& names, const char* unset) {
    if (names.empty()) return std::string(unset);
    const std::vector<std::string> kinds = ObjectKindsOf(names.names);
    return is_prepared_once() ? kinds[rng.UniformInt(kinds.size())] : turn().Choose(kinds);
  };
  Add(spec, kTarget, draw(task_.objects, kDefaultVessel), rng);
  Add(spec, kReceiver, draw(task_.receivers, kReceiver), rng);
  for (int i = 0; i < task_.grains; ++i) {
    // They get their places in the vessel once its own is drawn.
    spec.objects.push_back({.name = fmt::format("{}_grain_{}", kTarget, i),
                            .shape = Shape::kSphere,
                            .size = Vec3{task_.grain_radius, 0, 0},
                            .rgba = kNamedColours[3].rgba,
                            .mass = 2500 * 4.0 / 3 * kPi * std::pow(task_.grain_radius, 3),
                            .friction = Vec3{0.3, 0.01, 0.001},
                            .condim = Condim::kTangential,
                            .pos = Vec3{3 * task_.grain_radius * i, 0, -10}});
  }
}

void PourTask::Found(const Scene& scene, const TaskSetting& /*setting*/) {
  for (const char* name : {kTarget, kReceiver}) {
    scene.compiled()->object(name);
    Name(name, StemInScene(scene, name));
  }
}

std::vector<std::string> PourTask::StatedGoal() const {
  return {fmt::format("{} poured_into {} {}", kTarget, kReceiver, task_.share)};
}

std::string PourTask::WhyNotFrom(const std::string& kind, const PourTaskConfig& fields) {
  if (fields.grains < 1 || !(fields.grain_radius > 0)) return "";  // reported already
  const Scene scene = SceneWith(kind);
  if (std::string why = WhyNoVessel(scene, kind); !why.empty()) return why;
  const Vessel vessel(scene, kTarget);
  if (!GrainPlaces(vessel, fields.grains, fields.grain_radius).empty()) return "";
  return DoNotFit(vessel, kind, fields);
}

std::string PourTask::WhyNotInto(const std::string& kind) {
  return WhyNoVessel(SceneWith(kind), kind);
}

std::optional<Refusal> PourTask::Draw(Scene& scene, Rng& /*rng*/) {
  const Vessel vessel(scene, kTarget);
  const std::vector<std::string> grains = GrainsOf(scene, kTarget);
  const std::vector<Eigen::Vector3d> places =
      GrainPlaces(vessel, static_cast<int>(grains.size()), task_.grain_radius);
  if (places.empty())
    throw ArgumentError(place() + ": " + DoNotFit(vessel, kind_of(kTarget), task_));
  const Pose body = vessel.pose();
  for (size_t i = 0; i < grains.size(); ++i)
    scene.SetBodyPose(scene.compiled()->object(grains[i]).root_body, Pose(body * places[i]));
  return std::nullopt;
}

std::optional<Refusal> PourTask::CheckStart(const Scene& scene) {
  const Vessel vessel(scene, kTarget);
  for (const std::string& grain : GrainsOf(scene, kTarget)) {
    const std::string& body = scene.compiled()->object(grain).root_body;
    if (!vessel.Contains(scene.body_pose(body).translation()))
      return Refusal{.reason = "a grain is not in the vessel", .detail = grain};
  }
  return RelationTask::CheckStart(scene);
}

std::vector<Feature> PourTask::signals() const {
  return {Share("poured", "The share of the grains that is in the receiver.")};
}

void PourTask::Observe(const Scene& /*scene*/, std::span<double> out) const {
  out[0] = goals().empty() ? 0 : goals().front().bound->Progress();
}

}  // namespace robocell::internal
