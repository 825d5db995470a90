#include "robocell/task/navigate_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/spec/yaml.h"
#include "robocell/spec/yaml_reader.h"
#include "robocell/spec/yaml_writer.h"
#include "robocell/task/door_swings.h"

namespace robocell {

template <>
std::string ToYaml(const NavigateTaskConfig& fields) {
  return internal::yaml::TextOf(fields);
}
template <>
NavigateTaskConfig FromYamlUnchecked(std::string_view text) {
  return internal::yaml::SpecOf<NavigateTaskConfig>(text);
}

namespace internal {
namespace {

constexpr double kSpeedAtRest = 0.05;  // m/s and rad/s
// The expert drives a little nearer than what counts.
constexpr double kWellWithin = 0.9;

// Returns the body that a name of the annotations means.
std::string BodyNamed(const Scene& scene, const std::string& object) {
  for (const ObjectRecord& record : scene.compiled()->objects())
    if (record.name == object) return record.root_body;
  return FindId(scene.model(), mjOBJ_BODY, object) > 0 ? object : "";
}

}  // namespace

// The annotations are read here, while they can be.
void NavigateTask::Prepare(SceneSpec& /*spec*/, Rng& /*rng*/) { known_ = &annotations(); }

void NavigateTask::Bind(const Scene& scene, const TaskSetting& setting) {
  place_ = setting.place;
  robots_.clear();
  for (const std::string& name : setting.robots) robots_.push_back(Robot::Of(scene, name));
  if (robots_.empty()) throw ArgumentError(place_ + ": a task of kind 'navigate' needs a robot");
  FindDestinations(scene);
  Choose(0);
}

void NavigateTask::FindDestinations(const Scene& scene) {
  const SceneAnnotations none;
  const SceneAnnotations& known = known_ ? *known_ : none;
  destinations_.clear();
  std::vector<std::string> names;
  const auto add_name = [&](const std::string& name) {
    if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  std::map<std::string, int> said;
  for (const ObjectWords& object : known.objects)
    if (!object.words.empty()) ++said[object.words.front()];
  for (const Room& room : known.rooms) ++said[room.category];
  Destination meant{.word = fields_.to, .rooms = {}, .body = ""};
  for (const Room& room : known.rooms) {
    if (room.outline.size() < 3) continue;
    add_name(room.name);
    add_name(room.category);
    const std::string& word = room.category.empty() ? room.name : room.category;
    if (!fields_.to.empty() && (fields_.to == room.name || fields_.to == room.category)) {
      meant.word = word;
      meant.rooms.push_back(room);
    }
    if (fields_.to.empty() && said[room.category] == 1) destinations_.push_back({word, {room}, ""});
  }
  if (!meant.rooms.empty()) destinations_.push_back(std::move(meant));
  for (const ObjectWords& object : known.objects) {
    add_name(object.object);
    const std::string body = BodyNamed(scene, object.object);
    const std::string word = object.words.empty() ? object.category : object.words.front();
    if (body.empty() || word.empty()) continue;
    if (fields_.to.empty() ? said[word] != 1 : fields_.to != object.object) continue;
    destinations_.push_back({word, {}, body});
    const auto own = std::ranges::find_if(known.rooms, [&](const Room& room) {
      return !object.room.empty() && room.outline.size() >= 3 &&
             (room.name == object.room || room.category == object.room);
    });
    if (own != known.rooms.end()) destinations_.back().rooms.push_back(*own);
  }
  if (destinations_.empty() && !fields_.to.empty()) {
    if (const std::string body = BodyNamed(scene, fields_.to); !body.empty())
      destinations_.push_back({fields_.to, {}, body});
  }
  if (!destinations_.empty()) return;
  if (fields_.to.empty()) {
    throw NotFoundError(place_ +
                        ": the scene has no room and no object that words mean alone. Name where "
                        "the robot goes: task.to");
  }
  throw NotFoundError(place_ + ": task.to: " + NoSuchName("", "room or object", fields_.to, names) +
                      " Other scenes may have it: leave out this one, such as by scenes.houses");
}

const NavigateTask::Destination& NavigateTask::destination() const {
  if (destinations_.empty()) throw Error(place_ + ": the task is not bound to a scene");
  return destinations_[chosen_];
}

void NavigateTask::Choose(size_t number) {
  chosen_ = number;
  word_ = destination().word;
}

BodyPoses NavigateTask::Starts(Rng& rng) {
  Choose(rng.UniformInt(destinations_.size()));
  return {};
}

std::optional<Refusal> NavigateTask::Arrange(Scene& scene, Rng& /*rng*/) {
  if (!fields_.open_doors || !known_) return std::nullopt;
  for (const Articulation& door : internal::DoorsOf(*known_, scene))
    JointOpening::Of(scene, door.joint).Put(1);
  scene.Forward();
  return std::nullopt;
}

std::optional<std::vector<FloorPlace>> NavigateTask::FindWay(const Robot& robot) const {
  const Scene scene = robot.scene();
  scene.SyncPoses();
  const Destination& to = destination();
  internal::FloorWays ways(robot);
  if (to.body.empty()) {
    std::vector<FloorPlace> places;
    for (const Room& room : to.rooms) {
      const std::vector<FloorPlace> in_room = ways.PlacesIn(room);
      places.insert(places.end(), in_room.begin(), in_room.end());
    }
    return ways.FindWay(places);
  }
  const Room* room = to.rooms.empty() ? nullptr : &to.rooms.front();
  const int body = RequireId(scene.model(), mjOBJ_BODY, to.body, place_);
  return ways.FindWay(
      ways.PlacesBeside(internal::FootprintOf(scene, body), kWellWithin * fields_.within, room));
}

std::optional<Refusal> NavigateTask::CheckStart(const Scene& scene) {
  scene.SyncPoses();
  for (const Robot& robot : robots_) {
    if (IsThere(scene, robot)) return Refusal{kTooNear, "the robot is there already"};
    const auto way = FindWay(robot);
    if (!way) return Refusal{kNoWay, "to the " + word_ + " for robot '" + robot.name() + "'"};
    if (const double length = LengthOf(*way); length < fields_.least_way)
      return Refusal{kTooNear, fmt::format("{:.2f} m to the {}", length, word_)};
  }
  return std::nullopt;
}

double NavigateTask::Distance(const Scene& scene, const Robot& robot) const {
  const Destination& to = destination();
  const Eigen::Vector2d at = robot.base().pose().translation().head<2>();
  if (!to.body.empty()) {
    const int body = RequireId(scene.model(), mjOBJ_BODY, to.body, place_);
    return internal::FootprintOf(scene, body).exteriorDistance(at);
  }
  double nearest = HUGE_VAL;
  for (const Room& room : to.rooms) {
    if (internal::IsInRoom(room, at)) return 0;
    const auto& outline = room.outline;
    for (size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d a(outline[i][0], outline[i][1]);
      const Eigen::Vector2d b(outline[(i + 1) % outline.size()][0],
                              outline[(i + 1) % outline.size()][1]);
      const double along =
          std::clamp((at - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-12), 0.0, 1.0);
      nearest = std::min(nearest, (at - a - along * (b - a)).norm());
    }
  }
  return nearest;
}

bool NavigateTask::IsNear(const Scene& scene, const Robot& robot) const {
  const Destination& to = destination();
  const Eigen::Vector2d at = robot.base().pose().translation().head<2>();
  const auto is_in = [&](const Room& room) { return internal::IsInRoom(room, at); };
  if (!to.rooms.empty() && std::ranges::none_of(to.rooms, is_in)) return false;
  return to.body.empty() || Distance(scene, robot) <= fields_.within;
}

bool NavigateTask::IsThere(const Scene& scene, const Robot& robot) const {
  if (!IsNear(scene, robot)) return false;
  const Destination& to = destination();
  const Pose base = robot.base().pose();
  const Eigen::Vector2d at = base.translation().head<2>();
  if (!to.body.empty()) {
    const int body = RequireId(scene.model(), mjOBJ_BODY, to.body, place_);
    const Eigen::Vector2d ahead = internal::FootprintOf(scene, body).center() - at;
    const double bearing = std::atan2(ahead.y(), ahead.x());
    if (std::abs(std::remainder(bearing - internal::PlaceOf(base).yaw, 2 * M_PI)) > fields_.facing)
      return false;
  }
  return std::ranges::all_of(robot.base().joint_vel(),
                             [](double speed) { return std::abs(speed) < kSpeedAtRest; });
}

void NavigateTask::Begin(const Scene& scene) {
  scene.SyncPoses();
  first_distance_ = Distance(scene, robots_.front());
}

TaskVerdict NavigateTask::Judge(const Scene& scene) {
  scene.SyncPoses();
  TaskVerdict verdict;
  verdict.success =
      std::ranges::all_of(robots_, [&](const Robot& robot) { return IsThere(scene, robot); });
  const double left = Distance(scene, robots_.front());
  const double share = first_distance_ > 0 ? std::clamp(1 - left / first_distance_, 0.0, 1.0) : 0;
  verdict.progress = verdict.success ? 1 : 0.99 * share;
  verdict.reward = verdict.progress;
  verdict.subtask =
      std::ranges::all_of(robots_, [&](const Robot& robot) { return IsNear(scene, robot); });
  return verdict;
}

std::vector<double> NavigateTask::memory() const {
  return {static_cast<double>(chosen_), first_distance_};
}

void NavigateTask::Recall(std::span<const double> memory) {
  const size_t last = destinations_.empty() ? 0 : destinations_.size() - 1;
  Choose(std::min(last, static_cast<size_t>(std::max(0.0, memory[0]))));
  first_distance_ = memory[1];
}

std::string NavigateTask::WhyNotRecalled(std::span<const double> memory) const {
  const double number = memory[0];
  if (!(number >= 0 && number < static_cast<double>(destinations_.size()) &&
        number == std::floor(number)))
    return fmt::format("number 0, where the robot goes, is {:g}; it is a whole number from 0 to {}",
                       number, destinations_.size() - 1);
  if (memory[1] >= 0 && std::isfinite(memory[1])) return "";
  return fmt::format("number 1, the distance at the start, is {:g}; it is finite and not below 0",
                     memory[1]);
}

}  // namespace internal
}  // namespace robocell
