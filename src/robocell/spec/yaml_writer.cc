#include "robocell/spec/yaml_writer.h"

#include <algorithm>

#include <fmt/format.h>

namespace robocell::internal::yaml {

Writer::Writer() = default;
Writer::~Writer() = default;

void Writer::BeginMap() { out_ << YAML::BeginMap; }
void Writer::WriteKey(const char* key) { out_ << YAML::Key << key << YAML::Value; }
void Writer::WriteKey(const std::string& key) { out_ << YAML::Key << key << YAML::Value; }
void Writer::EndMap() { out_ << YAML::EndMap; }

void Writer::WriteKind(const KindSpec& value) {
  WriteField(value.registry().key(), value.kind());
  // Empty values are left out, unless that would restore a default that is not empty.
  const auto is_absent = [](const KindFieldRef& field) {
    return std::visit([](const auto* of) { return IsAbsent(*of); }, field.value);
  };
  const std::shared_ptr<KindFields> plain = value.registry().Make(value.kind());
  const std::vector<KindFieldRef> fields = value.shared_fields()->refs();
  const std::vector<KindFieldRef> defaults = plain->refs();
  for (size_t i = 0; i < fields.size(); ++i) {
    if (is_absent(fields[i]) && is_absent(defaults[i])) continue;
    std::visit([&](const auto* of) { WriteField(fields[i].name, *of); }, fields[i].value);
  }
}

void Writer::BeginSequence(bool flow) {
  if (flow) out_ << YAML::Flow;
  out_ << YAML::BeginSeq;
}

void Writer::EndSequence() { out_ << YAML::EndSeq; }
void Writer::WriteNull() { out_ << YAML::Null; }
void Writer::WriteWord(const char* word) { out_ << word; }

void Writer::Write(double value) { out_ << fmt::format("{}", value); }
void Writer::Write(const std::string& value) { out_ << value; }

void Writer::Write(const NameList& value) {
  out_ << YAML::Flow << YAML::BeginSeq;
  for (const std::string& name : value) {
    if (name.find("..") != std::string::npos) out_ << YAML::DoubleQuoted;  // not a range
    out_ << name;
  }
  out_ << YAML::EndSeq;
}

void Writer::Write(const IndexList& value) {
  const std::vector<int>& v = value.values;
  const bool rising = v.size() > 2 && v.back() - v.front() == static_cast<int>(v.size()) - 1 &&
                      std::is_sorted(v.begin(), v.end()) &&
                      std::adjacent_find(v.begin(), v.end()) == v.end();
  if (rising) {
    out_ << fmt::format("{}..{}", v.front(), v.back());
  } else {
    Write(v);
  }
}

void Writer::Write(const Pose& value) {
  out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "pos" << YAML::Value;
  Write(ToVec3(value.translation()));
  out_ << YAML::Key << "quat" << YAML::Value;
  Write(value.quaternion());
  out_ << YAML::EndMap;
}

void Writer::Write(const AttachTarget& value) {
  if (value.name.empty()) {
    out_ << ToString(value.kind);
  } else {
    out_ << YAML::Flow << YAML::BeginMap << YAML::Key << ToString(value.kind) << YAML::Value
         << value.name << YAML::EndMap;
  }
}

void Writer::Write(const RandomNumber& value) {
  const bool is_plain = value.value && !value.uniform && !value.log_uniform && value.choice.empty();
  if (is_plain) return Write(*value.value);
  WriteFields(value);
}

void Writer::Write(const RandomizedValue& value) {
  double number = 0;
  const bool is_word = value.numbers.empty() && !value.word.empty() &&
                       !YAML::convert<double>::decode(YAML::Node(value.word), number);
  if (is_word) return Write(value.word);
  if (value.numbers.empty() || !value.word.empty()) return WriteFields(value);
  if (value.numbers.size() == 1) return Write(value.numbers.front());
  Write(value.numbers);
}

void Writer::Write(const ElementRef& value) {
  if (!value.kind && value.body.empty()) {
    out_ << value.name;
    return;
  }
  out_ << YAML::Flow;
  if (value.kind) out_ << YAML::BeginMap << YAML::Key << ToString(*value.kind) << YAML::Value;
  if (value.body.empty()) {
    out_ << value.name;
  } else {
    out_ << YAML::BeginMap << YAML::Key << "body" << YAML::Value << value.body << YAML::Key
         << "index" << YAML::Value << value.index << YAML::EndMap;
  }
  if (value.kind) out_ << YAML::EndMap;
}

}  // namespace robocell::internal::yaml
