#include "robocell/scenes/houses/prepared_house.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/version.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scenes/houses/house_metadata.h"
#include "robocell/scenes/support.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostModelBytes = uint64_t{128} << 20;  // of the model's text
constexpr uint64_t kMostAssetBytes = uint64_t{8} << 30;    // of all files of a house
constexpr size_t kMostFiles = 50'000;
constexpr double kLeastMass = 1e-6, kLeastInertia = 1e-9;  // kg and kg m^2, of a mended body
constexpr size_t kMostListed = 3;

bool IsBelow(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_normal().lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

// Returns true if `entry` is the hash of an asset, 32 hexadecimal digits, that is a part of a body's
// name: "mug_<hash>_1_0_2".
bool HasHash(const std::string& name, const std::string& entry) {
  constexpr size_t kDigits = 32;
  const auto is_hex = [](unsigned char c) { return std::isxdigit(c) != 0; };
  if (entry.size() != kDigits || !std::ranges::all_of(entry, is_hex)) return false;
  const size_t at = name.find(entry);
  if (at == std::string::npos) return false;
  const size_t end = at + kDigits;
  return (at == 0 || name[at - 1] == '_') && (end == name.size() || name[end] == '_');
}

std::string Shortened(const std::vector<std::string>& all) {
  const size_t shown = std::min(all.size(), kMostListed);
  std::string text;
  for (size_t i = 0; i < shown; ++i) text += (i ? ", " : "") + all[i];
  if (shown < all.size()) text += fmt::format(" and {} more", all.size() - shown);
  return text;
}

// Files and folders whose changes count.
struct Watched {
  std::set<fs::path> of_good;  // of a house that can be used: documents, and folders of assets
  std::set<fs::path> of_bad;   // of one that does not compile: all of its files
};

// Returns why the files of a house cannot be used; "" if they can, with what is watched.
std::string WhyNotFiles(const HouseFiles& files, const HouseFolder& folder, Watched& watched) {
  std::error_code error;
  const uint64_t bytes = fs::file_size(files.model, error);
  if (error) return "its model cannot be read";
  if (bytes > kMostModelBytes)
    return fmt::format("its model has {} MB; {} MB are read at most", bytes >> 20,
                       kMostModelBytes >> 20);
  const ModelFiles found = FindModelFiles(files.model);
  if (!found.no_files.empty())
    return fmt::format("its model names '{}', which is no file", found.no_files.front().name);
  std::vector<std::string> missing, outside;
  for (const MissingFile& file : found.missing) {
    if (file.name.empty())
      return fmt::format("'{}' is no XML that can be read: {}", file.document.string(),
                         file.reason);
    missing.push_back(file.name);
  }
  if (!missing.empty())
    return fmt::format("{} of its assets {} missing: {}", missing.size(),
                       missing.size() == 1 ? "is" : "are", Shortened(missing));
  uint64_t total = 0;
  for (const fs::path& file : found.files) {
    // Files of other houses come and go in the house's own folder.
    if (file.parent_path() != files.model.parent_path()) watched.of_good.insert(file.parent_path());
    if (file.extension() == ".xml") watched.of_good.insert(file);
    watched.of_bad.insert(file);
    total += fs::file_size(file, error);
    const bool is_inside = std::ranges::any_of(
        folder.roots(), [&](const fs::path& root) { return IsBelow(file, root); });
    if (!is_inside) outside.push_back(file.string());
  }
  if (!outside.empty())
    return fmt::format(
        "its model names files outside of '{}': {}; set ROBOCELL_SCENE_PATH to a "
        "folder that has both",
        folder.path().string(), Shortened(outside));
  if (found.files.size() > kMostFiles || total > kMostAssetBytes)
    return fmt::format("it has {} files with {} MB; {} and {} MB are read at most",
                       found.files.size(), total >> 20, kMostFiles, kMostAssetBytes >> 20);
  return "";
}

// Principal moments of inertia have to be positive, and none larger than the others together.
bool AreMoments(const double moments[3]) {
  std::array<double, 3> sorted = {moments[0], moments[1], moments[2]};
  for (const double moment : sorted) {
    if (!std::isfinite(moment)) return false;
  }
  std::ranges::sort(sorted);
  return sorted[0] > 0 && sorted[0] + sorted[1] >= sorted[2];
}

// Returns the principal moments of a body with an explicit inertia.
std::array<double, 3> MomentsOf(const mjsBody* body) {
  const double* full = body->fullinertia;  // xx yy zz xy xz yz
  if (std::isnan(full[0])) return {body->inertia[0], body->inertia[1], body->inertia[2]};
  const double matrix[9] = {full[0], full[3], full[4], full[3], full[1],
                            full[5], full[4], full[5], full[2]};
  double moments[3], axes[9], quat[4];
  mju_eig3(moments, axes, quat, matrix);
  return {moments[0], moments[1], moments[2]};
}

// Edits the description of a house.
class Mending {
 public:
  Mending(mjSpec* spec, const HouseFiles& files) : spec_(spec), files_(files) {}

  // Makes explicit inertias possible: the mean of the moments, at least the smallest mass.
  void MendInertias() {
    std::vector<std::string> names;
    for (mjsElement* e = mjs_firstElement(spec_, mjOBJ_BODY); e; e = mjs_nextElement(spec_, e)) {
      mjsBody* body = mjs_asBody(e);
      if (!body->explicitinertial || mjs_getId(e) == 0) continue;
      const std::array<double, 3> moments = MomentsOf(body);
      const bool has_mass = std::isfinite(body->mass) && body->mass > 0;
      if (has_mass && AreMoments(moments.data())) continue;
      if (!has_mass) body->mass = kLeastMass;
      double mean = 0;
      for (const double moment : moments) mean += std::isfinite(moment) ? std::abs(moment) / 3 : 0;
      mju_fill(body->inertia, std::max(mean, kLeastInertia), 3);
      body->fullinertia[0] = NAN;
      names.push_back(mjs_getString(mjs_getName(e)));
    }
    if (names.empty()) return;
    Record("balanced", names);
    notes_.push_back(
        fmt::format("impossible inertias of {} were balanced: {}",
                    names.size() == 1 ? "one body" : std::to_string(names.size()) + " bodies",
                    Shortened(names)));
  }
  // Removes the bodies whose name contains one of the entries, or whose asset is one of them.
  void Remove(const std::vector<std::string>& entries) {
    if (entries.empty()) return;
    std::map<std::string, HouseObject> objects;
    if (!files_.metadata.empty()) {
      try {
        objects = ReadHouseMetadata(files_.metadata).objects;
      } catch (const IoError&) {  // the annotations report it
      }
    }
    const auto is_listed = [&](const std::string& name) {
      const auto object = objects.find(name);
      return std::ranges::any_of(entries, [&](const std::string& entry) {
        return name == entry || HasHash(name, entry) ||
               (object != objects.end() &&
                (object->second.asset == entry || object->second.id == entry));
      });
    };
    std::vector<std::string> names;
    for (mjsElement* e = mjs_firstElement(spec_, mjOBJ_BODY); e;) {
      const std::string name = mjs_getString(mjs_getName(e));
      if (mjs_getId(e) == 0 || !is_listed(name)) {
        e = mjs_nextElement(spec_, e);
        continue;
      }
      if (Tried("leaving out body '" + name + "'", [&] { return mjs_delete(spec_, e); }) != 0)
        throw SpecError(
            fmt::format("body '{}' cannot be left out. MuJoCo: {}", name, mjs_getError(spec_)));
      names.push_back(name);
      e = mjs_firstElement(spec_, mjOBJ_BODY);  // the tree below it went too
    }
    if (names.empty()) return;
    Record("left out", names);
    while (mjsElement* key = mjs_firstElement(spec_, mjOBJ_KEY)) mjs_delete(spec_, key);
    notes_.push_back(
        fmt::format("left out {}: {}", Counted(names.size(), "object"), Shortened(names)));
  }
  // What was changed, for people: long lists of names are shortened.
  const std::vector<std::string>& notes() const { return notes_; }
  // The same with every name. Two equal ones of the same model give the same house.
  const std::string& changes() const { return changes_; }

 private:
  void Record(const char* change, const std::vector<std::string>& names) {
    changes_ += fmt::format("{} {}\n", change, names.size());
    for (const std::string& name : names) changes_ += fmt::format("{} {}\n", name.size(), name);
  }

  mjSpec* spec_;
  const HouseFiles& files_;
  std::vector<std::string> notes_;
  std::string changes_;
};

// Lets relative names of assets start at the house's own folder, from a model in `start`. A dataset
// that keeps both can be moved, because the names stay relative.
void MakeFoldersRelative(mjSpec* spec, const fs::path& folder, const fs::path& start) {
  const fs::path from = fs::weakly_canonical(start);
  for (mjString* name : {spec->compiler.meshdir, spec->compiler.texturedir}) {
    const fs::path target = fs::weakly_canonical(folder / mjs_getString(name));
    mjs_setString(name, target.lexically_relative(from).string().c_str());
  }
}

// Returns the file in the cache. Its name follows from the model with all its files, and from every
// change.
fs::path WriteMended(mjSpec* spec, const HouseFiles& files, const std::string& context,
                     const std::string& changes) {
  std::string key = fmt::format("{}\n{}\n{}", files.model.string(), Version(), changes);
  for (const fs::path& file : FindModelFiles(files.model).files) key += FileIdentity(file) + "\n";
  const fs::path file = HousesCacheFolder() / "mended" /
                        fmt::format("{}_{}.xml", Fingerprint(key), files.model.stem().string());
  if (CanReadFile(file)) return file;
  Compile(spec, nullptr, context, nullptr, JacobianGuard::kOff);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  MakeFoldersRelative(spec, files.model.parent_path(), file.parent_path());
  AtomicWrite(file, SaveXmlString(spec, context));
  return file;
}

// What is known of a house, on the disk: a set has thousands of houses, and each process of a run
// would read them all. It holds while nothing watched changes.
class PreparedOnDisk {
 public:
  explicit PreparedOnDisk(const std::string& key)
      : file_(HousesCacheFolder() / "prepared" /
              (Fingerprint(key + "\n" + std::string(Version())) + ".json")) {}

  std::optional<PreparedHouse> Read() const {
    if (!CanReadFile(file_)) return std::nullopt;
    try {
      const nlohmann::json json = nlohmann::json::parse(ReadRealFile(file_));
      for (const auto& [path, identity] : json.at("watched").items()) {
        if (FileIdentity(path) != identity.get<std::string>()) return std::nullopt;
      }
      PreparedHouse house{.why_not = json.value("why_not", ""),
                          .model = json.at("model").get<std::string>(),
                          .notes = json.at("notes").get<std::vector<std::string>>()};
      if (CanReadFile(house.model)) return house;
    } catch (const std::exception&) {  // a damaged file is written again
    }
    return std::nullopt;
  }
  void Write(const PreparedHouse& house, const std::set<fs::path>& watched) const {
    nlohmann::json identities = nlohmann::json::object();
    for (const fs::path& path : watched) identities[path.string()] = FileIdentity(path);
    nlohmann::json json = {
        {"watched", identities}, {"model", house.model.string()}, {"notes", house.notes}};
    if (!house.why_not.empty()) json["why_not"] = house.why_not;
    std::error_code error;
    fs::create_directories(file_.parent_path(), error);
    try {
      AtomicWrite(file_, json.dump());
    } catch (const std::exception&) {  // without it the house is prepared again
    }
  }

 private:
  fs::path file_;
};

// Throws SpecError for a house in which no object and no robot can stand.
void RequirePlace(const fs::path& model) {
  try {
    FindSupport({.name = model.stem().string(), .base = model.string(), .timestep = 0.002});
  } catch (const NotFoundError&) {
    throw SpecError("it has neither a level face for objects nor a free floor");
  }
}

// `does_compile` becomes false if the model's own content is why the house cannot be used.
PreparedHouse Prepare(const HouseFiles& files, const HouseFolder& folder, Watched& watched,
                      bool& does_compile) {
  const std::string context = fmt::format("house '{}'", files.model.string());
  PreparedHouse house{
      .why_not = WhyNotFiles(files, folder, watched), .model = files.model, .notes = {}};
  if (!house.why_not.empty()) return house;
  try {
    const SpecPtr spec = ParseXmlFile(files.model, context);
    Mending mending(spec.get(), files);
    mending.MendInertias();
    mending.Remove(folder.without());
    house.notes = mending.notes();
    if (!house.notes.empty())
      house.model = WriteMended(spec.get(), files, context, mending.changes());
    else
      Compile(spec.get(), nullptr, context, nullptr, JacobianGuard::kOff);
    RequirePlace(house.model);
  } catch (const SpecError& error) {
    does_compile = false;
    house.why_not = error.what();
  } catch (const Error& error) {  // of files, which may pass: a full disk
    house.why_not = error.what();
  }
  return house;
}

}  // namespace

fs::path HousesCacheFolder() { return SceneCacheFolder().parent_path() / "houses"; }

PreparedHouse PrepareHouse(const HouseFiles& files, const HouseFolder& folder) {
  static std::mutex mutex;
  static std::map<std::string, PreparedHouse> known;
  std::string key = FileIdentity(files.model) + "\n" + FileIdentity(files.metadata) + "\n";
  for (const std::string& entry : folder.without()) key += entry + "\n";
  for (const fs::path& root : folder.roots()) key += root.string() + "\n";
  const std::string place = key + HousesCacheFolder().string();
  {
    const std::lock_guard lock(mutex);
    const auto it = known.find(place);
    if (it != known.end() && CanReadFile(it->second.model)) return it->second;
  }
  const PreparedOnDisk on_disk(key);
  std::optional<PreparedHouse> house = on_disk.Read();
  if (!house) {
    Watched watched;
    bool does_compile = true;
    house = Prepare(files, folder, watched, does_compile);  // without the lock: it may log
    const bool is_good = house->why_not.empty();
    if (is_good || !does_compile)  // missing files may come later
      on_disk.Write(*house, is_good ? watched.of_good : watched.of_bad);
  }
  if (!house->why_not.empty()) return *house;
  const std::lock_guard lock(mutex);
  return known[place] = *std::move(house);
}

}  // namespace robocell::internal
