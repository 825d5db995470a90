#include "robocell/data/feature_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

using FeatureJson = nlohmann::json;

constexpr std::array kRoles = {FeatureRole::kObservation, FeatureRole::kPrivileged,
                               FeatureRole::kAction, FeatureRole::kLabel};
constexpr std::array kTypes = {ColumnType::kFloat64, ColumnType::kFloat32, ColumnType::kInt64,
                               ColumnType::kInt32,   ColumnType::kUint8,   ColumnType::kBool};

// Infinite numbers, which JSON lacks, become null.
FeatureJson ToBounds(const std::vector<double>& values) {
  FeatureJson bounds = FeatureJson::array();
  for (const double value : values)
    bounds.push_back(std::isfinite(value) ? FeatureJson(value) : FeatureJson());
  return bounds;
}

// Reads the fields of one feature and names a wrong one.
class FeatureReader {
  [[noreturn]] void Fail(const std::string& field, const std::string& what) const {
    throw SpecError(
        fmt::format("{}{}: {}", place_, field.empty() ? "" : ", field '" + field + "'", what));
  }
  const FeatureJson* Get(const char* field, bool required = false) {
    known_.emplace_back(field);
    if (const auto found = object_.find(field); found != object_.end()) return &*found;
    if (required) Fail(field, "is missing");
    return nullptr;
  }
  std::string Text(const char* field, bool required = false) {
    const FeatureJson* value = Get(field, required);
    if (!value) return "";
    if (!value->is_string()) Fail(field, "expected a text, found " + value->dump());
    return value->get<std::string>();
  }
  std::vector<std::string> Texts(const char* field) {
    std::vector<std::string> texts;
    const FeatureJson* value = Get(field);
    if (!value) return texts;
    if (!value->is_array()) Fail(field, "expected a list of texts, found " + value->dump());
    for (const FeatureJson& item : *value) {
      if (!item.is_string()) Fail(field, "expected a list of texts, found " + value->dump());
      texts.push_back(item.get<std::string>());
    }
    return texts;
  }
  std::vector<int64_t> Sizes(const char* field) {
    std::vector<int64_t> sizes;
    const FeatureJson* value = Get(field, true);
    if (!value->is_array()) Fail(field, "expected a list of sizes, found " + value->dump());
    int64_t all = 1;
    for (const FeatureJson& item : *value) {
      constexpr int64_t kMost = int64_t{1} << 40;
      if (!item.is_number_integer() || item.get<int64_t>() < 1 || item.get<int64_t>() > kMost / all)
        Fail(field, "expected sizes of at least 1, found " + value->dump());
      sizes.push_back(item.get<int64_t>());
      all *= sizes.back();
    }
    return sizes;
  }
  std::vector<double> Bounds(const char* field, double open) {
    std::vector<double> bounds;
    const FeatureJson* value = Get(field);
    if (!value) return bounds;
    if (!value->is_array()) Fail(field, "expected a list of numbers, found " + value->dump());
    for (const FeatureJson& item : *value) {
      if (!item.is_number() && !item.is_null())
        Fail(field, "expected a list of numbers, found " + value->dump());
      bounds.push_back(item.is_null() ? open : item.get<double>());
    }
    return bounds;
  }
  void RequireNothingElse() const {
    for (const auto& [field, value] : object_.items()) {
      if (std::ranges::find(known_, field) == known_.end())
        Fail(field, "is unknown. Fields: " + ListNames(known_));
    }
  }
  template <class Values>
  auto OneOf(const char* field, const Values& values) {
    const std::string text = Text(field, true);
    std::vector<std::string> names;
    for (const auto value : values) {
      if (NameOf(value) == text) return value;
      names.emplace_back(NameOf(value));
    }
    Fail(field, NoSuchName("", field, text, names));
  }

 public:
  FeatureReader(const FeatureJson& object, size_t index) : object_(object) {
    place_ = fmt::format("features[{}]", index);
    if (!object.is_object()) Fail("", "expected an object");
    if (object.contains("name") && object["name"].is_string())
      place_ = fmt::format("feature '{}'", object["name"].get<std::string>());
  }

  Feature Read() {
    Feature feature;
    feature.column = {.name = Text("name", true),
                      .type = OneOf("dtype", kTypes),
                      .shape = Sizes("shape"),
                      .units = Text("unit"),
                      .frame = Text("frame"),
                      .names = Texts("names"),
                      .values = Texts("values"),
                      .description = Text("description")};
    feature.role = OneOf("role", kRoles);
    const double infinity = std::numeric_limits<double>::infinity();
    feature.lower = Bounds("lower", -infinity);
    feature.upper = Bounds("upper", infinity);
    feature.source = Text("source");
    RequireNothingElse();
    return feature;
  }

 private:
  const FeatureJson& object_;
  std::string place_;
  std::vector<std::string> known_;
};

std::string KindText(const Feature& feature) {
  const ColumnSpec& c = feature.column;
  std::string text =
      fmt::format("{} {} {}", NameOf(feature.role), NameOf(c.type), ShapeText(c.shape));
  if (!c.units.empty()) text += " in " + c.units;
  if (!c.frame.empty()) text += ", frame " + c.frame;
  return text;
}

}  // namespace

std::string_view NameOf(FeatureRole role) {
  switch (role) {
    case FeatureRole::kObservation:
      return "observation";
    case FeatureRole::kPrivileged:
      return "privileged";
    case FeatureRole::kAction:
      return "action";
    case FeatureRole::kLabel:
      break;
  }
  return "label";
}

void FeatureSchema::Add(Feature feature) {
  const std::string& name = feature.column.name;
  if (name.empty()) throw ArgumentError("a feature needs a name");
  if (Has(name)) throw ArgumentError(fmt::format("feature '{}' is declared twice", name));
  const auto fits = [&](const std::vector<double>& bounds) {
    return bounds.empty() || static_cast<int64_t>(bounds.size()) == feature.size();
  };
  if (!fits(feature.lower) || !fits(feature.upper) ||
      feature.lower.size() != feature.upper.size()) {
    throw ArgumentError(fmt::format("feature '{}': its range has {} and {}, and it has {}", name,
                                    Counted(std::ssize(feature.lower), "lower bound"),
                                    Counted(std::ssize(feature.upper), "upper bound"),
                                    Counted(feature.size(), "number")));
  }
  for (size_t i = 0; i < feature.lower.size(); ++i) {
    if (feature.lower[i] <= feature.upper[i]) continue;
    throw ArgumentError(fmt::format("feature '{}': the lower bound of number {} is {}, above {}",
                                    name, i, feature.lower[i], feature.upper[i]));
  }
  features_.push_back(std::move(feature));
}

const Feature& FeatureSchema::Find(std::string_view name) const {
  std::vector<std::string> names;
  for (const Feature& feature : features_) {
    if (feature.column.name == name) return feature;
    names.push_back(feature.column.name);
  }
  throw NotFoundError(NoSuchName("", "feature", name, names));
}

bool FeatureSchema::Has(std::string_view name) const {
  return std::ranges::any_of(features_, [&](const Feature& f) { return f.column.name == name; });
}

std::vector<std::string> FeatureSchema::Names(FeatureRole role) const {
  std::vector<std::string> names;
  for (const Feature& feature : features_) {
    if (feature.role == role) names.push_back(feature.column.name);
  }
  return names;
}

int64_t FeatureSchema::size() const {
  int64_t size = 0;
  for (const Feature& feature : features_) size += feature.size();
  return size;
}

std::string FeatureSchema::ToJson() const {
  FeatureJson list = FeatureJson::array();
  for (const Feature& feature : features_) {
    const ColumnSpec& c = feature.column;
    FeatureJson object = {{"name", c.name},
                          {"role", std::string(NameOf(feature.role))},
                          {"dtype", std::string(NameOf(c.type))},
                          {"shape", c.shape}};
    const auto add = [&](const char* field, const auto& value) {
      if (!value.empty()) object[field] = value;
    };
    add("unit", c.units);
    add("frame", c.frame);
    add("names", c.names);
    add("values", c.values);
    add("description", c.description);
    add("lower", ToBounds(feature.lower));
    add("upper", ToBounds(feature.upper));
    add("source", feature.source);
    list.push_back(std::move(object));
  }
  return list.dump();
}

FeatureSchema FeatureSchema::FromJson(std::string_view text) {
  const FeatureJson list = FeatureJson::parse(text, nullptr, false);
  if (!list.is_array()) throw SpecError("features: expected a list of features in JSON");
  FeatureSchema schema;
  for (size_t i = 0; i < list.size(); ++i) {
    try {
      schema.Add(FeatureReader(list[i], i).Read());
    } catch (const ArgumentError& error) {
      throw SpecError(error.what());
    }
  }
  return schema;
}

std::string FeatureSchema::DifferenceFrom(const FeatureSchema& other, std::string_view here,
                                          std::string_view there) const {
  for (const Feature& feature : features_) {
    const std::string& name = feature.column.name;
    if (!other.Has(name)) return fmt::format("feature '{}' is {} and not {}", name, here, there);
    const Feature& theirs = other.Find(name);
    const std::string own = KindText(feature), its = KindText(theirs);
    if (own != its)
      return fmt::format("feature '{}' is {} {} and {} {}", name, own, here, its, there);
    if (feature.column.names != theirs.column.names) {
      return fmt::format("feature '{}' has the numbers {} {} and {} {}", name,
                         ListNames(feature.column.names), here, ListNames(theirs.column.names),
                         there);
    }
  }
  for (const Feature& feature : other.features_) {
    if (!Has(feature.column.name))
      return fmt::format("feature '{}' is {} and not {}", feature.column.name, there, here);
  }
  return "";
}

}  // namespace robocell
