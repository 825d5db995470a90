#include "robocell/scene/class_names.h"

#include <mujoco/mujoco.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "robocell/mujoco/guard.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

// The values of an attribute in XML text, wherever it stands.
std::set<std::string> AttributeValues(const std::string& xml, const std::string& attribute) {
  std::set<std::string> values;
  for (size_t at = xml.find(attribute); at != std::string::npos; at = xml.find(attribute, at + 1)) {
    const size_t open = xml.find_first_of("\"'", at);
    if (open == std::string::npos) break;
    const size_t close = xml.find(xml[open], open + 1);
    if (close == std::string::npos) break;
    values.insert(xml.substr(open + 1, close - open - 1));
  }
  return values;
}

std::string ReadText(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Candidates for names of default classes. The engine has no list of a spec's classes, so they are
// read from the text of the file and of what it includes; a word too many does no harm.
void CollectClassNames(const fs::path& file, std::set<fs::path>& seen,
                       std::set<std::string>& names) {
  if (!seen.insert(file).second) return;
  const std::string xml = ReadText(file);
  names.merge(AttributeValues(xml, "class="));
  if (xml.find("<include") == std::string::npos) return;
  for (const std::string& included : AttributeValues(xml, "file=")) {
    const fs::path path = file.parent_path() / included;
    if (path.extension() == ".xml") CollectClassNames(path, seen, names);
  }
}

std::string FreeName(const std::string& name, const mjSpec* part, const mjSpec* parent) {
  for (int i = 2;; ++i) {
    const std::string candidate = name + "_" + std::to_string(i);
    if (!mjs_findDefault(part, candidate.c_str()) && !mjs_findDefault(parent, candidate.c_str()))
      return candidate;
  }
}

// Bodies and frames say by name which class their contents have by default.
void RenameChildClass(mjSpec* spec, const std::string& from, const std::string& to) {
  for (mjsElement* e : SpecElements(spec, mjOBJ_BODY)) {
    mjString* name = mjs_asBody(e)->childclass;
    if (mjs_getString(name) == from) mjs_setString(name, to.c_str());
  }
  for (mjsElement* e : SpecElements(spec, mjOBJ_FRAME)) {
    mjString* name = mjs_asFrame(e)->childclass;
    if (mjs_getString(name) == from) mjs_setString(name, to.c_str());
  }
}

}  // namespace

void MakeClassNamesUnique(const Part& part, const mjSpec* parent) {
  if (part.file.empty()) return;
  std::set<fs::path> seen;
  std::set<std::string> names;
  CollectClassNames(part.file, seen, names);
  mjSpec* spec = part.spec.get();
  for (const std::string& name : names) {
    mjsDefault* own = name == "main" ? nullptr : mjs_findDefault(spec, name.c_str());
    if (!own || !mjs_findDefault(parent, name.c_str())) continue;
    const std::string fresh = FreeName(name, spec, parent);
    SetSpecName(own->element, fresh, part.place);
    RenameChildClass(spec, name, fresh);
  }
}

}  // namespace robocell
