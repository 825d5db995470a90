// Fuzzes names and paths: suggestions come from the candidates, no path leaves its root, models are
// found exactly where they may be, and ranges of names are expanded correctly. The first line is
// the name, the others are the candidates; their number selects the folder of the file that names a
// model. `@` at the beginning of the name is the searched folder of models, which has links out of
// it, in circles and to nothing.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"
#include "robocell/spec/containers.h"
#include "robocell/testing/temp_dir.h"

namespace fs = std::filesystem;

namespace {

// Files that may be found, and files that must not, in a folder of its own.
class Tree {
 public:
  Tree() {
    robocell::SetLogLevel(robocell::LogLevel::kNone);
    for (const char* file :
         {"secret.xml", "path/arm.xml", "path/deep/hand.xml", "path/a b/'q'.xml",
          "path/\u00fc/\u00e4.xml", "path/$(x).xml", "scenes/lab.xml",
          "models/robots/mine/mine.xml", "models/robots/other/mine.xml",
          "models/objects/cup/cup.xml", "models/scenes/lab.xml", "menagerie/maker_arm/arm.xml",
          "menagerie/maker_arm/scene.xml", "menagerie/maker_hand/left.xml",
          "menagerie/maker_hand/right.xml", "cache/models/maker_leg-0123456789abcdef/leg.xml",
          "cache/models/maker_leg-0123456789abcdef/.complete"})
      Write(file, "<mujoco/>");
    Write("user/robocell/menagerie.json", R"({"robots": {"maker_leg": {"tree": "fedcba9876"}}})");
    for (const auto& [link, target] :
         {std::pair<const char*, const char*>{"path/out.xml", "../secret.xml"},
          {"path/out", ".."},
          {"path/loop.xml", "loop.xml"},
          {"path/there", "back"},
          {"path/back", "there"},
          {"path/inside.xml", "deep/hand.xml"},
          {"path/nowhere.xml", "missing.xml"},
          {"models/robots/circle", "circle"},
          {"models/scenes/out.xml", "../../secret.xml"},
          {"menagerie/maker_arm/out.xml", "../../secret.xml"},
          {"menagerie/circle", "circle"}})
      fs::create_symlink(target, root() / link);
    Set("ROBOCELL_MODEL_PATH", "path");
    Set("ROBOCELL_MODELS", "models");
    Set("MENAGERIE_ROOT", "menagerie");
    Set("MENAGERIE_CACHE_DIR", "cache");
    Set("XDG_CACHE_HOME", "user");
  }

  fs::path root() const { return fs::canonical(folder_.path()); }

 private:
  void Write(const char* file, const char* text) const {
    fs::create_directories((root() / file).parent_path());
    std::ofstream(root() / file) << text;
  }
  void Set(const char* variable, const char* below) const {
    setenv(variable, (root() / below).c_str(), 1);
  }

  robocell::TempDir folder_;
};

bool IsBelow(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_relative(root);
  return !relative.empty() && *relative.begin() != "..";
}

// Resolves by the name alone or from the folder of a file, in one place or several.
void Resolve(const Tree& tree, const std::string& name, const fs::path& directory) {
  std::string found;
  try {
    found = robocell::assets::Resolve(name, directory.string());
  } catch (const robocell::Error&) {
    return;  // rejected or missing, which is fine
  }
  if (!fs::path(found).is_absolute() || !fs::is_regular_file(found)) std::abort();
  const bool menagerie = name.starts_with("menagerie:");
  if (!menagerie && fs::path(name).is_absolute()) return;  // an absolute path means that file
  const fs::path real = fs::canonical(found);
  if (menagerie) {
    if (!IsBelow(real, tree.root() / "menagerie") && !IsBelow(real, tree.root() / "cache"))
      std::abort();
    return;
  }
  for (const fs::path& start : {directory, fs::current_path()}) {
    if (!start.empty() && found == (start / name).lexically_normal()) return;  // `..` is allowed
  }
  if (!IsBelow(real, tree.root() / "path") && !IsBelow(real, tree.root() / "models")) std::abort();
}

// A range counts up by one, and expanding its names changes nothing.
void Expand(const std::string& text) {
  try {
    const robocell::NameList list = robocell::NameList::Expand(text);
    if (list.empty() || list.size() > 1001) std::abort();
    if (text.find("..") == std::string::npos && list.names != std::vector{text}) std::abort();
    for (size_t i = 1; i < list.size(); ++i) {
      if (list[i] == list[i - 1] || list[i].size() < list[i - 1].size()) std::abort();
      const std::string two = list[i - 1] + ".." + list[i];
      if (two.find("...") != std::string::npos || list[i].find("..") != std::string::npos) continue;
      if (robocell::NameList::Expand(two).names != std::vector{list[i - 1], list[i]}) std::abort();
    }
  } catch (const robocell::Error&) {
    return;  // a rejection is fine
  }
}

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  for (size_t end = 0; end != std::string_view::npos;
       text.remove_prefix(std::min(end + 1, text.size()))) {
    end = text.find('\n');
    lines.emplace_back(text.substr(0, end));
  }
  return lines;
}

void Suggest(const std::string& name, const std::vector<std::string>& candidates) {
  for (const std::string& nearest : robocell::NearestNames(name, candidates)) {
    if (std::find(candidates.begin(), candidates.end(), nearest) == candidates.end()) std::abort();
  }
  if (robocell::NoSuchName("place", "thing", name, candidates).empty()) std::abort();
}

void Join(const std::string& name) {
  const fs::path root = "/nowhere/root";
  try {
    const fs::path inside =
        robocell::internal::ConfinedPath(root, name).lexically_normal().lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..") std::abort();
  } catch (const robocell::Error&) {
    return;  // a rejection is fine
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<std::string> lines = Lines({reinterpret_cast<const char*>(data), size});
  const std::string name = lines.front();
  lines.erase(lines.begin());
  Suggest(name, lines);
  Join(name);
  Expand(name);
  static const Tree tree;
  const std::string full = name.starts_with('@') ? tree.root().string() + name.substr(1) : name;
  const fs::path directories[] = {"", tree.root() / "scenes", tree.root() / "path/loop.xml"};
  Resolve(tree, full, directories[lines.size() % 3]);
  return 0;
}
