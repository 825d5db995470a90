#include "robocell/task/grasp_library.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/base/cache_folder.h"
#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/log.h"
#include "robocell/base/npz.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/version.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/task/geometry_text.h"
#include "robocell/task/grasp_request.h"
#include "robocell/task/grasped_body.h"
#include "robocell/task/hand_geometry.h"
#include "robocell/task/remembered_grasps.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using internal::NpzArray;
using internal::NpzArrays;

constexpr int kFormat = 2;  // of the method: a new number makes all grasps again
constexpr size_t kMostRemembered = 256;
constexpr uint64_t kGraspCacheBytes = 256ULL << 20;  // largest size of the cache
constexpr double kRotationError = 1e-3;  // largest entry of R R^T - 1 that rounding explains

[[noreturn]] void FailFile(const fs::path& path, const std::string& what) {
  throw IoError(fmt::format("{}: {}", path.string(), what));
}

Pose PoseOfRow(const fs::path& path, size_t row, const double* numbers) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> x(numbers);
  const auto fail = [&](const char* what) {
    FailFile(path, fmt::format("transforms[{}] {}", row, what));
  };
  if (!x.allFinite()) fail("has numbers that are not finite");
  const Eigen::Matrix3d r = x.topLeftCorner<3, 3>();
  if ((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kRotationError ||
      r.determinant() < 0)
    fail("is not a rigid transform: its upper left 3x3 numbers are no rotation");
  if ((x.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kRotationError)
    fail("is not a rigid transform: its last row is not 0 0 0 1");
  const Eigen::Quaterniond q = Eigen::Quaterniond(r).normalized();
  return Pose(x.topRightCorner<3, 1>(), Quaternion{q.x(), q.y(), q.z(), q.w()});
}

// Returns one number, or `width` numbers, for each of the rows; null if the file has none.
const NpzArray* FindArray(const fs::path& path, const NpzArrays& arrays, const std::string& name,
                          size_t rows, size_t width, bool texts) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) return nullptr;
  const NpzArray& array = found->second;
  const std::vector<size_t> shape =
      width > 1 ? std::vector<size_t>{rows, width} : std::vector<size_t>{rows};
  if (array.shape != shape || (rows > 0 && array.texts.empty() == texts))
    FailFile(path, fmt::format("'{}' does not have one {} for each of the {} transforms", name,
                               texts       ? "text"
                               : width > 1 ? "vector"
                                           : "number",
                               rows));
  for (const double number : array.numbers)
    if (!std::isfinite(number))
      FailFile(path, fmt::format("'{}' has numbers that are not finite", name));
  return &array;
}

struct Library {
  std::string name;
  fs::path folder;
};

struct Libraries {
  std::mutex mutex;
  std::vector<Library> all;                              // the latest last
  std::map<std::string, std::vector<Grasp>> remembered;  // generated in this process, by key
};
Libraries& TheLibraries() {
  static Libraries libraries;
  return libraries;
}

// Returns true for the name of an entry of a folder: it leads neither out of it nor deeper.
bool IsFolderName(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

// The names under which a library may have an object.
std::vector<std::string> NamesOf(const Scene& scene, const internal::GraspedBody& grasped) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (IsFolderName(name) && std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  add(grasped.object);
  for (const SceneObject& object : scene.spec().objects) {
    if (object.name != grasped.object || object.mjcf_path.empty()) continue;
    const fs::path path(object.mjcf_path);
    add(path.stem().string());
    add(path.parent_path().filename().string());
  }
  add(grasped.name);
  return names;
}

bool IsJointed(const mjModel* m, const internal::GraspedBody& grasped) {
  return m->body_jntnum[grasped.body] > 0 &&
         m->jnt_type[m->body_jntadr[grasped.body]] != mjJNT_FREE;
}

// The files in an object's folder that have the grasps of a body, in the order of preference.
std::vector<std::string> FilesOf(const Scene& scene, const internal::GraspedBody& grasped,
                                 const std::string& object) {
  const mjModel* m = scene.model();
  if (!IsJointed(m, grasped)) return {"grasps.npz", object + "_grasps_filtered.npz"};
  std::vector<std::string> files;
  const std::string full = ElementName(m, mjOBJ_JOINT, m->body_jntadr[grasped.body]);
  for (const std::string& joint : {full, internal::NameInObject(scene, grasped.body, full)}) {
    if (!IsFolderName(joint)) continue;
    files.push_back("joint_grasps_" + joint + ".npz");
    files.push_back(joint + "_grasps_filtered.npz");
  }
  return files;
}

// Returns the files of all libraries that have grasps of the body, the latest library first.
std::vector<fs::path> FindFiles(const Robot& robot, const internal::GraspedBody& grasped) {
  std::vector<Library> libraries;
  {
    Libraries& known = TheLibraries();
    const std::lock_guard lock(known.mutex);
    libraries = known.all;
  }
  if (libraries.empty()) return {};
  const Scene scene = robot.scene();
  const std::vector<std::string> names = NamesOf(scene, grasped);
  std::vector<fs::path> files;
  std::ranges::reverse(libraries);
  for (const Library& library : libraries) {
    for (const std::string& name : names) {
      std::vector<fs::path> folders;
      for (const std::string& hand : {robot.config().name, robot.name()})
        if (IsFolderName(hand)) folders.push_back(library.folder / name / hand);
      folders.push_back(library.folder / name);
      for (const fs::path& folder : folders) {
        for (const std::string& file : FilesOf(scene, grasped, name)) {
          std::error_code error;
          if (fs::is_regular_file(folder / file, error)) files.push_back(folder / file);
        }
      }
    }
  }
  return files;
}

// A file's grasps, and which arrays it lacks.
struct GraspFile {
  std::vector<Grasp> grasps;
  bool has_kinds = false, has_openings = false, has_approaches = false;
};

GraspFile ReadGraspFile(const fs::path& path);

// Reads a file and fills in what it lacks.
std::vector<Grasp> ReadComplete(const fs::path& path, const internal::GraspedBody& grasped,
                                const GripperShape& shape, const mjModel* m) {
  GraspFile file = ReadGraspFile(path);
  const Eigen::Vector3d approach = shape.grasp_in_tcp().rotation().col(2);
  for (Grasp& grasp : file.grasps) {
    if (!file.has_openings) grasp.opening = shape.open_gap();
    if (!file.has_approaches) grasp.approach = grasp.tcp_in_body.rotation() * approach;
    if (file.has_kinds) continue;
    grasp.kind = shape.is_suction()      ? GraspKind::kSuction
                 : IsJointed(m, grasped) ? GraspKind::kHandle
                                         : internal::KindOfApproach(grasp.approach);
  }
  std::ranges::stable_sort(file.grasps, std::ranges::greater(), &Grasp::score);
  return std::move(file.grasps);
}

std::string KeyText(const Robot& robot, const internal::GraspRequest& request,
                    const GraspOptions& options) {
  const internal::HandGeometry hand(robot, request.shape);
  const internal::GraspedBody& grasped = request.grasped;
  const Scene scene = robot.scene();
  const mjModel* m = scene.model();
  const mjData* d = hand.data();
  std::string text = fmt::format("{} {} ", Version(), kFormat) + hand.Description();
  const Pose frame =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * grasped.body, d->xmat + 9 * grasped.body)
          .inverse();
  for (const std::vector<int>* geoms : {&grasped.geoms, &grasped.other_geoms}) {
    for (const int g : *geoms) {
      internal::AppendGeomShape(m, g, &text);
      internal::AppendPose(
          internal::RoundedPose(
              frame * Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g)),
          &text);
      text += internal::IsHandleGeom(scene, g) ? "h" : "-";
      text += std::ranges::find(request.geoms, g) != request.geoms.end() ? "x" : "-";
    }
    text += "|";
  }
  internal::AppendPose(
      internal::RoundedPose(Pose(frame * Eigen::Vector3d(d->subtree_com + 3 * grasped.body))),
      &text);
  for (const GraspKind kind : options.kinds) text += ToString(kind) + " ";
  internal::AppendNumbers(
      std::array{static_cast<double>(options.samples), static_cast<double>(options.most),
                 static_cast<double>(options.seed % (1ULL << 32)),
                 static_cast<double>(options.seed >> 32), options.friction, options.clearance,
                 options.approach_length},
      &text);
  return text;
}

GraspFile ReadGraspFile(const fs::path& path) {
  const NpzArrays arrays =
      internal::ReadNpz(path, {"transforms", "kinds", "openings", "widths", "asides", "approaches",
                               "approach_lengths", "scores"});
  const auto found = arrays.find("transforms");
  if (found == arrays.end()) {
    const std::set<std::string> all = internal::NpzNames(path);
    const std::vector<std::string> names(all.begin(), all.end());
    FailFile(path, "has no array 'transforms' with the poses of the TCP. Its arrays: " +
                       (names.empty() ? "none" : ListNames(names)));
  }
  const NpzArray& poses = found->second;
  if (poses.shape.size() != 3 || poses.shape[1] != 4 || poses.shape[2] != 4 || !poses.texts.empty())
    FailFile(path, fmt::format("'transforms' must be (N, 4, 4) numbers, got ({})",
                               fmt::join(poses.shape, ", ")));
  const size_t rows = poses.shape[0];
  GraspFile file{.grasps = std::vector<Grasp>(rows),
                 .has_kinds = arrays.contains("kinds"),
                 .has_openings = arrays.contains("openings"),
                 .has_approaches = arrays.contains("approaches")};
  std::vector<Grasp>& grasps = file.grasps;
  for (size_t i = 0; i < rows; ++i) {
    grasps[i].tcp_in_body = PoseOfRow(path, i, poses.numbers.data() + 16 * i);
    grasps[i].score = 1 - static_cast<double>(i) / static_cast<double>(rows);  // the best first
  }
  const auto read = [&](const char* name, double Grasp::*member, double least) {
    const NpzArray* array = FindArray(path, arrays, name, rows, 1, false);
    for (size_t i = 0; array && i < rows; ++i) {
      if (array->numbers[i] < least)
        FailFile(path,
                 fmt::format("{}[{}] is {:g}, below {:g}", name, i, array->numbers[i], least));
      grasps[i].*member = array->numbers[i];
    }
  };
  read("openings", &Grasp::opening, 0);
  read("widths", &Grasp::width, 0);
  read("asides", &Grasp::aside, 0);
  read("approach_lengths", &Grasp::approach_length, 0);
  read("scores", &Grasp::score, -1e9);
  if (const NpzArray* kinds = FindArray(path, arrays, "kinds", rows, 1, true)) {
    for (size_t i = 0; i < rows; ++i) {
      try {
        grasps[i].kind = GraspKindOf(kinds->texts[i]);
      } catch (const NotFoundError& error) {
        FailFile(path, fmt::format("kinds[{}]: {}", i, error.what()));
      }
    }
  }
  if (const NpzArray* ways = FindArray(path, arrays, "approaches", rows, 3, false)) {
    for (size_t i = 0; i < rows; ++i) {
      const Eigen::Map<const Eigen::Vector3d> way(ways->numbers.data() + 3 * i);
      if (way.norm() < 1e-9)
        FailFile(path, fmt::format("approaches[{}] is no direction: it is 0", i));
      grasps[i].approach = way.normalized();
    }
  }
  return file;
}

// Keeps the grasps that a request wants.
void KeepWanted(const internal::GraspRequest& request, const GraspOptions& options,
                std::vector<Grasp>* grasps) {
  std::erase_if(*grasps, [&](const Grasp& grasp) { return !request.Wants(grasp.kind); });
  if (grasps->size() > static_cast<size_t>(options.most))
    grasps->resize(static_cast<size_t>(options.most));
}

std::vector<Grasp> Remembered(const std::string& key,
                              const std::function<std::vector<Grasp>()>& make) {
  Libraries& known = TheLibraries();
  {
    const std::lock_guard lock(known.mutex);
    if (const auto found = known.remembered.find(key); found != known.remembered.end())
      return found->second;
  }
  std::vector<Grasp> made = make();
  const std::lock_guard lock(known.mutex);
  if (known.remembered.size() >= kMostRemembered) known.remembered.clear();
  known.remembered[key] = made;
  return made;
}

// Reads grasps from the cache's file; unset if there are none.
std::optional<std::vector<Grasp>> ReadStored(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  try {
    std::vector<Grasp> grasps = ReadGraspFile(path).grasps;
    internal::MarkUsed(path);
    return grasps;
  } catch (const IoError& damaged) {
    Log(LogLevel::kWarn, fmt::format("{}. The grasps are generated again", damaged.what()));
    return std::nullopt;
  }
}

void Store(const fs::path& path, const std::vector<Grasp>& grasps) {
  try {
    SaveGrasps(path, grasps);
    internal::PruneFolder(path.parent_path(), ".npz", kGraspCacheBytes);
  } catch (const IoError& failed) {
    Log(LogLevel::kWarn, fmt::format("grasps are not stored: {}", failed.what()));
  }
}

}  // namespace

GraspSet LoadGrasps(const fs::path& path, const Robot& robot, const std::string& body) {
  const internal::GraspRequest request = internal::CheckedRequest(robot, body, {});
  return {.robot = robot.name(),
          .body = request.grasped.name,
          .grasps = ReadComplete(path, request.grasped, *request.shape, robot.scene().model())};
}

void SaveGrasps(const fs::path& path, const std::vector<Grasp>& grasps) {
  const size_t rows = grasps.size();
  std::vector<double> poses, ways, openings, widths, asides, lengths, scores;
  std::vector<std::string> kinds;
  for (const Grasp& grasp : grasps) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> x = grasp.tcp_in_body.matrix();
    poses.insert(poses.end(), x.data(), x.data() + 16);
    ways.insert(ways.end(), grasp.approach.data(), grasp.approach.data() + 3);
    openings.push_back(grasp.opening);
    widths.push_back(grasp.width);
    asides.push_back(grasp.aside);
    lengths.push_back(grasp.approach_length);
    scores.push_back(grasp.score);
    kinds.push_back(ToString(grasp.kind));
  }
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error)
    throw IoError(
        fmt::format("cannot create '{}': {}", path.parent_path().string(), error.message()),
        error.value());
  internal::WriteNpz(path, {{"transforms", NpzArray::Numbers({rows, 4, 4}, std::move(poses))},
                            {"approaches", NpzArray::Numbers({rows, 3}, std::move(ways))},
                            {"openings", NpzArray::Numbers({rows}, std::move(openings))},
                            {"widths", NpzArray::Numbers({rows}, std::move(widths))},
                            {"asides", NpzArray::Numbers({rows}, std::move(asides))},
                            {"approach_lengths", NpzArray::Numbers({rows}, std::move(lengths))},
                            {"scores", NpzArray::Numbers({rows}, std::move(scores))},
                            {"kinds", NpzArray::Texts(std::move(kinds))}});
}

void RegisterGraspLibrary(const std::string& name, const fs::path& folder) {
  if (name.empty()) throw ArgumentError("register_grasp_library: the name is empty");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw NotFoundError(
        fmt::format("register_grasp_library('{}'): '{}' is not a folder. Give the folder with "
                    "<object>/<robot>/grasps.npz",
                    name, folder.string()));
  }
  const fs::path absolute = fs::absolute(folder);
  Libraries& known = TheLibraries();
  const std::lock_guard lock(known.mutex);
  std::erase_if(known.all, [&](const Library& library) { return library.name == name; });
  known.all.push_back({name, absolute});
}

void UnregisterGraspLibrary(const std::string& name) {
  const std::vector<std::string> names = GraspLibraryNames();
  Libraries& known = TheLibraries();
  const std::lock_guard lock(known.mutex);
  if (std::erase_if(known.all, [&](const Library& library) { return library.name == name; }) == 0)
    throw NotFoundError(NoSuchName("", "grasp library", name, names));
}

std::vector<std::string> GraspLibraryNames() {
  Libraries& known = TheLibraries();
  const std::lock_guard lock(known.mutex);
  std::vector<std::string> names;
  for (const Library& library : known.all) names.push_back(library.name);
  return names;
}

fs::path GraspCacheFolder() { return SceneCacheFolder().parent_path() / "grasps"; }

std::string GraspKey(const Robot& robot, const std::string& body, const GraspOptions& options) {
  return Fingerprint(KeyText(robot, internal::CheckedRequest(robot, body, options), options));
}

GraspSet GraspsOf(const Robot& robot, const std::string& body, const GraspOptions& options,
                  bool stored) {
  const internal::GraspRequest request = internal::CheckedRequest(robot, body, options);
  GraspSet set{.robot = robot.name(), .body = request.grasped.name, .grasps = {}};
  for (const fs::path& file : FindFiles(robot, request.grasped)) {
    set.grasps = ReadComplete(file, request.grasped, *request.shape, robot.scene().model());
    KeepWanted(request, options, &set.grasps);
    if (!set.grasps.empty()) return set;
    Log(LogLevel::kInfo,
        fmt::format("{} has no grasps of the kinds that are asked for", file.string()));
  }
  const std::string key = Fingerprint(KeyText(robot, request, options));
  set.grasps = Remembered(key, [&] {
    const fs::path path = GraspCacheFolder() / (key + ".npz");
    if (stored)
      if (std::optional<std::vector<Grasp>> read = ReadStored(path)) return std::move(*read);
    std::vector<Grasp> made = GenerateGrasps(robot, body, options).grasps;
    if (stored) Store(path, made);
    return made;
  });
  return set;
}

GraspSet internal::RememberedGrasps(const Robot& robot, const std::string& body,
                                    const GraspOptions& options) {
  const GraspRequest request = CheckedRequest(robot, body, options);
  // Under a key of their own: grasps that were read from a file differ in the last bits.
  const std::string key = "generated " + Fingerprint(KeyText(robot, request, options));
  return {.robot = robot.name(),
          .body = request.grasped.name,
          .grasps = Remembered(key, [&] { return GenerateGrasps(robot, body, options).grasps; })};
}

}  // namespace robocell
