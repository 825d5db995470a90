#include "robocell/mujoco/parse_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <span>
#include <sstream>
#include <system_error>
#include <vector>

#include "robocell/base/lfs_pointer.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

constexpr const char* kReference = "https://mujoco.readthedocs.io/en/stable/XMLreference.html";

using Schema = std::map<std::string, std::vector<std::string>>;

// Returns the attributes of MJCF's elements; for elements that occur in several places, all of
// them.
Schema ReadSchema() {
  std::vector<char> text(1 << 18);
  const int size = mj_printSchema(nullptr, text.data(), static_cast<int>(text.size()), 0, 0);
  std::istringstream lines(std::string(text.data(), static_cast<size_t>(std::max(size, 0))));
  Schema schema;
  std::string line, element;
  while (std::getline(lines, line)) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    const bool begins = words.size() > 1 && words[1].front() == '(';  // "geom (*)  axisangle ..."
    if (begins) element = words[0].substr(words[0].find(')') + 1);    // "(world)body (R) ..."
    std::vector<std::string>& attributes = schema[element];
    attributes.insert(attributes.end(), words.begin() + (begins ? 2 : 0), words.end());
  }
  schema["worldbody"];
  return schema;
}

// Suggests files beside a missing one: " Did you mean 'assets.xml'?"
std::string FilesBeside(const std::string& model, const std::string& missing) {
  namespace fs = std::filesystem;
  const fs::path wanted = fs::path(model).parent_path() / missing;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(wanted.parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const fs::path& path = it->path();
    if (path.extension() == wanted.extension() && path != fs::path(model))
      names.push_back((fs::path(missing).parent_path() / path.filename()).string());
  }
  if (names.empty()) return "";
  std::sort(names.begin(), names.end());
  const std::string nearest = DidYouMean(missing, names);
  return nearest.empty() ? " There: " + ListNames(names) + "." : nearest;
}

std::string Suggestion(const std::string& what, const std::string& element,
                       const std::string& file) {
  const Schema schema = ReadSchema();
  std::smatch found;
  if (std::regex_search(what, found, std::regex("unrecognized attribute: '(.*)'"))) {
    const auto known = schema.find(element);
    return known == schema.end() ? "" : DidYouMean(found[1].str(), known->second);
  }
  if (std::regex_search(what, found, std::regex("opening file '(.*)'")))
    return FilesBeside(file, found[1].str());
  if (!what.starts_with("unrecognized element")) return "";
  std::vector<std::string> elements;
  for (const auto& [name, attributes] : schema) elements.push_back(name);
  return DidYouMean(element, elements);
}

std::string Without(const std::string& text, const std::string& beginning) {
  return text.starts_with(beginning) ? text.substr(beginning.size()) : text;
}

std::string Place(const std::string& file, const std::string& line) {
  const bool known = !line.empty() && line != "0";  // it is 0 in files that the model includes
  if (file.empty()) return known ? "line " + line + ": " : "";
  return known ? file + ":" + line + ": " : file + ": ";
}

// "XML parse error 14:\nError=XML_ERROR_MISMATCHED_ELEMENT ... Line number=2: XMLElement name=body"
std::string NotWellFormed(const std::string& complaint, const std::string& file) {
  if (const std::string pointer = LfsPointerAdvice({file}); !pointer.empty()) return pointer;
  std::smatch found;
  std::regex_search(complaint, found, std::regex(R"(Error=XML_ERROR_(\w+))"));
  std::string what = found.empty() ? complaint : found[1].str();
  std::transform(what.begin(), what.end(), what.begin(),
                 [](unsigned char c) { return c == '_' ? ' ' : std::tolower(c); });
  std::smatch line, name;
  std::regex_search(complaint, line, std::regex("Line number=(\\d+)"));
  std::regex_search(complaint, name, std::regex("name=(\\w+)"));
  const std::string element = name.empty() ? "" : fmt::format("<{}>: ", name[1].str());
  return fmt::format(
      "{}{}not well-formed XML: {}. Each element that is opened is closed, inside of the one "
      "around "
      "it, and each attribute is written name=\"value\"",
      Place(file, line.empty() ? "" : line[1].str()), element, what);
}

// Replaces comments by spaces; lines stay.
std::string WithoutComments(std::string xml) {
  for (size_t begin = xml.find("<!--"); begin != xml.npos; begin = xml.find("<!--", begin)) {
    const size_t end = std::min(xml.find("-->", begin), xml.size());
    std::replace_if(
        xml.begin() + begin, xml.begin() + end, [](char c) { return c != '\n'; }, ' ');
  }
  return xml;
}

// Returns true for attributes whose text is a name, which may be "nan".
bool IsName(const std::string& attribute) {
  static const std::set<std::string> kNames = {
      "name",   "class",  "childclass", "model",   "body",   "body1",    "body2",   "joint",
      "joint1", "joint2", "geom",       "geom1",   "geom2",  "site",     "site1",   "site2",
      "mesh",   "target", "material",   "texture", "tendon", "actuator", "objname", "refname"};
  return kNames.contains(attribute);
}

// Returns true if a text is a list of numbers, not all of them numbers.
bool HasNan(const std::string& text) {
  bool found = false;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* const end = word.data() + word.size();
    double number = 0;  // std::strtod would follow the locale of the program
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error == std::errc::invalid_argument || rest != end) return false;
    found |= std::isnan(number);
  }
  return found;
}

// Returns the file that line `line` of a model includes; "" if it shows none.
std::string IncludedAt(const std::string& file, const std::string& line) {
  std::ifstream stream(file);
  std::string text;
  for (int left = std::atoi(line.c_str()); left > 0 && std::getline(stream, text);) --left;
  std::smatch found;
  const std::regex include(R"re(<include\s[^>]*file\s*=\s*["']([^"']+)["'])re");
  return std::regex_search(text, found, include) ? found[1].str() : "";
}

struct NumberField {
  const char* name;  // name in MJCF
  mjtObj kind;
  const mjtNum* numbers;
  mjtSize rows;
  int per_row;
  const int* owners = nullptr;  // owners of the rows, unless these are the elements
};

std::string ProblemIn(const mjModel* m, const NumberField& field) {
  const auto finite = [](mjtNum number) { return std::isfinite(number); };
  const mjtNum* end = field.numbers + field.rows * field.per_row;
  const mjtNum* bad = std::find_if_not(field.numbers, end, finite);
  if (bad == end) return "";
  const auto row = static_cast<int>((bad - field.numbers) / field.per_row);
  const int id = field.owners ? field.owners[row] : row;
  const char* name = mj_id2name(m, field.kind, id);
  const std::span<const mjtNum> numbers(field.numbers + row * field.per_row, field.per_row);
  return fmt::format(
      "Error: {} is {}; it must be finite. Correct it there\nElement name '{}', id {}", field.name,
      fmt::join(numbers, " "), name ? name : "", id);
}

}  // namespace

bool IsAboutNan(const std::string& warning) { return warning.find("NaN") != warning.npos; }

std::string NanProblem(const std::string& file) {
  std::ifstream stream(file);
  const std::string xml = WithoutComments({std::istreambuf_iterator<char>(stream), {}});
  const std::regex attribute(R"re((\w+)\s*=\s*["']([^"']*)["'])re");
  const std::string next =
      "Correct it there, or leave the attribute out to have what MuJoCo takes without it";
  for (std::sregex_iterator at(xml.begin(), xml.end(), attribute), end; at != end; ++at) {
    if (IsName((*at)[1]) || !HasNan((*at)[2])) continue;
    const auto line = 1 + std::count(xml.begin(), xml.begin() + at->position(), '\n');
    return fmt::format("{}{}=\"{}\" is not a number. {}", Place(file, std::to_string(line)),
                       (*at)[1].str(), (*at)[2].str(), next);
  }
  return fmt::format("{}a number of the model, or of a file that it includes, is NaN. {}",
                     Place(file, ""), next);
}

std::string ParseProblem(const std::string& complaint, const std::string& file) {
  if (complaint.starts_with("XML parse error")) return NotWellFormed(complaint, file);
  // "XML Error: Schema violation: unrecognized element\nElement 'bdy', line 1"
  std::smatch found;
  const bool placed =
      std::regex_search(complaint, found, std::regex("\\s*\nElement '([^']*)', line (\\d+)"));
  std::string what = placed ? found.prefix().str() : complaint;
  // "Include error: 'XML parse error 6:\nError=XML_ERROR_PARSING_ELEMENT ... Line number=3\n'"
  if (placed && what.find("Include error: 'XML parse error") != what.npos) {
    const std::string included = IncludedAt(file, found[2].str());
    return NotWellFormed(
        what, included.empty() ? file + " or a file that it includes"
                               : (std::filesystem::path(file).parent_path() / included).string());
  }
  for (const char* word : {"XML Error: ", "Schema violation: ", "ParseXML: ", "Error: "})
    what = Without(what, word);
  const std::string element = placed ? found[1].str() : "";
  const std::string tag = placed ? fmt::format("<{}>: ", element) : "";
  return fmt::format("{}{}{}.{} Correct it there; MJCF's elements and attributes: {}",
                     Place(file, placed ? found[2].str() : ""), tag, what,
                     Suggestion(what, element, file), kReference);
}

std::string NonFiniteElement(const mjModel* m) {
  const NumberField fields[] = {
      {"pos", mjOBJ_BODY, m->body_pos, m->nbody, 3},
      {"the orientation", mjOBJ_BODY, m->body_quat, m->nbody, 4},
      {"mass", mjOBJ_BODY, m->body_mass, m->nbody, 1},
      {"the pos of its inertia", mjOBJ_BODY, m->body_ipos, m->nbody, 3},
      {"the orientation of its inertia", mjOBJ_BODY, m->body_iquat, m->nbody, 4},
      {"its inertia", mjOBJ_BODY, m->body_inertia, m->nbody, 3},
      {"gravcomp", mjOBJ_BODY, m->body_gravcomp, m->nbody, 1},
      {"pos", mjOBJ_JOINT, m->jnt_pos, m->njnt, 3},
      {"axis", mjOBJ_JOINT, m->jnt_axis, m->njnt, 3},
      {"stiffness", mjOBJ_JOINT, m->jnt_stiffness, m->njnt, 1},
      {"damping", mjOBJ_JOINT, m->dof_damping, m->nv, 1, m->dof_jntid},
      {"armature", mjOBJ_JOINT, m->dof_armature, m->nv, 1, m->dof_jntid},
      {"frictionloss", mjOBJ_JOINT, m->dof_frictionloss, m->nv, 1, m->dof_jntid},
      {"size", mjOBJ_GEOM, m->geom_size, m->ngeom, 3},
      {"pos", mjOBJ_GEOM, m->geom_pos, m->ngeom, 3},
      {"the orientation", mjOBJ_GEOM, m->geom_quat, m->ngeom, 4},
      {"friction", mjOBJ_GEOM, m->geom_friction, m->ngeom, 3},
      {"margin", mjOBJ_GEOM, m->geom_margin, m->ngeom, 1},
      {"pos", mjOBJ_SITE, m->site_pos, m->nsite, 3},
      {"the orientation", mjOBJ_SITE, m->site_quat, m->nsite, 4},
      {"size", mjOBJ_SITE, m->site_size, m->nsite, 3},
      {"pos", mjOBJ_CAMERA, m->cam_pos, m->ncam, 3},
      {"the orientation", mjOBJ_CAMERA, m->cam_quat, m->ncam, 4},
      {"stiffness", mjOBJ_TENDON, m->tendon_stiffness, m->ntendon, 1},
      {"damping", mjOBJ_TENDON, m->tendon_damping, m->ntendon, 1},
      {"its gain", mjOBJ_ACTUATOR, m->actuator_gainprm, m->nactuator, mjNGAIN},
      {"its bias", mjOBJ_ACTUATOR, m->actuator_biasprm, m->nactuator, mjNBIAS},
  };
  for (const NumberField& field : fields) {
    if (std::string problem = ProblemIn(m, field); !problem.empty()) return problem;
  }
  return "";
}

}  // namespace robocell::internal
