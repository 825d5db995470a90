#include "robocell/scenes/houses/house_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/real_file.h"

namespace robocell::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMostObjects = 100'000, kMostDepth = 64;

// Reads the fields of one object, and counts those of another type.
class Fields {
 public:
  Fields(const Json& json, int* ignored) : json_(json), ignored_(ignored) {}

  void Text(const char* key, std::string& out) const {
    const Json* value = Find(key);
    if (!value) return;
    if (value->is_string())
      out = value->get<std::string>();
    else if (value->is_number_integer())
      out = std::to_string(value->get<int64_t>());
    else
      ++*ignored_;
  }
  void Flag(const char* key, bool& out) const {
    const Json* value = Find(key);
    if (!value) return;
    if (value->is_boolean())
      out = value->get<bool>();
    else
      ++*ignored_;
  }
  void Number(const char* key, std::optional<int>& out) const {
    const Json* value = Find(key);
    if (!value) return;
    const double number = value->is_number() ? value->get<double>() : NAN;
    if (std::abs(number) <= 1e9)
      out = static_cast<int>(std::lround(number));
    else
      ++*ignored_;
  }
  void Texts(const char* key, std::vector<std::string>& out) const {
    const Json* value = Find(key);
    if (!value) return;
    if (!value->is_array()) return void(++*ignored_);
    for (const Json& item : *value) {
      if (item.is_string())
        out.push_back(item.get<std::string>());
      else
        ++*ignored_;
    }
  }
  void Names(const char* key, std::map<std::string, std::string>& out) const {
    const Json* value = Find(key);
    if (!value) return;
    if (!value->is_object()) return void(++*ignored_);
    for (const auto& [name, text] : value->items()) {
      if (text.is_string())
        out[name] = text.get<std::string>();
      else
        ++*ignored_;
    }
  }
  const Json* Find(const char* key) const {
    const auto it = json_.find(key);
    return it == json_.end() || it->is_null() ? nullptr : &*it;
  }

 private:
  const Json& json_;
  int* ignored_;
};

HouseObject ObjectOf(const Json& json, int* ignored) {
  const Fields fields(json, ignored);
  HouseObject object;
  fields.Text("category", object.category);
  fields.Text("asset_id", object.asset);
  fields.Text("object_id", object.id);
  fields.Text("parent", object.parent);
  fields.Texts("children", object.children);
  fields.Texts("words", object.words);
  fields.Number("room_id", object.room);
  fields.Flag("is_static", object.is_static);
  if (const Json* map = fields.Find("name_map"); map && map->is_object()) {
    const Fields names(*map, ignored);
    names.Names("bodies", object.bodies);
    names.Names("joints", object.joints);
    names.Names("sites", object.sites);
  }
  return object;
}

}  // namespace

HouseMetadata ReadHouseMetadata(const std::filesystem::path& path, int* ignored) {
  const std::string text = ReadRealFile(path);
  const auto fail = [&](const std::string& reason) {
    throw IoError(fmt::format("metadata '{}': {}", path.string(), reason));
  };
  // The parser's own depth is unlimited, and its recursion ends with the stack.
  size_t depth = 0;
  const auto limit = [&](int level, Json::parse_event_t event, Json& /*value*/) {
    if (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start)
      depth = std::max(depth, static_cast<size_t>(level));
    return depth <= kMostDepth;
  };
  Json json = Json::parse(text, limit, false);
  if (depth > kMostDepth) fail(fmt::format("it is nested deeper than {} levels", kMostDepth));
  if (json.is_discarded()) fail("it is not JSON");
  if (!json.is_object()) fail("it is not an object with the key `objects`");
  const auto objects = json.find("objects");
  if (objects == json.end() || !objects->is_object())
    fail("its key `objects` is not an object of objects by their bodies");
  if (objects->size() > kMostObjects)
    fail(fmt::format("it has {} objects; {} are read at most", objects->size(), kMostObjects));
  HouseMetadata metadata;
  int count = 0;
  for (const auto& [body, object] : objects->items()) {
    if (object.is_object())
      metadata.objects[body] = ObjectOf(object, &count);
    else
      ++count;
  }
  if (ignored) *ignored = count;
  return metadata;
}

std::string HouseMetadataText(const HouseMetadata& metadata) {
  Json objects = Json::object();
  for (const auto& [body, object] : metadata.objects) {
    Json out = {{"hash_name", body},
                {"asset_id", object.asset},
                {"object_id", object.id},
                {"category", object.category},
                {"object_enum", object.is_static ? "static_object" : "pickup_object"},
                {"is_static", object.is_static},
                {"name_map",
                 {{"bodies", object.bodies}, {"joints", object.joints}, {"sites", object.sites}}},
                {"parent", object.parent.empty() ? Json() : Json(object.parent)},
                {"room_id", object.room ? Json(*object.room) : Json()},
                {"children", object.children},
                {"words", object.words}};
    objects[body] = std::move(out);
  }
  return Json{{"objects", std::move(objects)}}.dump(1) + "\n";
}

std::string WordsOfCategory(const std::string& category) {
  std::string words;
  bool was_lower = false;
  for (const unsigned char c : category) {
    if (c == '_' || c == '-' || c == ' ' || c == '|') {
      if (!words.empty() && words.back() != ' ') words += ' ';
      was_lower = false;
      continue;
    }
    if (std::isupper(c) && was_lower) words += ' ';
    words += static_cast<char>(std::tolower(c));
    was_lower = std::islower(c) || std::isdigit(c);
  }
  while (!words.empty() && words.back() == ' ') words.pop_back();
  return words;
}

}  // namespace robocell::internal
