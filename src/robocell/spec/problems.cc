#include "robocell/spec/problems.h"

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/spec/locations.h"

namespace robocell {

Problems::Scope::Scope(Problems& problems, std::string_view key)
    : problems_(problems), length_(problems.path_.size()) {
  if (!problems_.path_.empty()) problems_.path_ += '.';
  problems_.path_ += key;
}

Problems::Scope::Scope(Problems& problems, size_t index)
    : problems_(problems), length_(problems.path_.size()) {
  problems_.path_ += '[' + std::to_string(index) + ']';
}

Problems::Scope::~Scope() { problems_.path_.resize(length_); }

void Problems::Add(const std::string& message) { AddFromSource(locations_.At(path_), message); }

void Problems::AddAt(std::string_view field, const std::string& message) {
  Scope scope(*this, field);
  Add(message);
}

void Problems::AddFromSource(const std::string& source, const std::string& message) {
  const auto [place, rest] = SplitPlace(message);
  if (place.empty()) {
    list_.push_back({path_, message, source});
  } else {
    list_.push_back({"", rest, place});
  }
}

void Problems::AppendBelow(const Problems& other) {
  for (const Problem& p : other.list_) {
    list_.push_back({JoinPath(path_, p.path), p.message, p.source});
  }
  for (const auto& [path, label] : other.labels_) labels_[JoinPath(path_, path)] = label;
}

void Problems::NameEntry(size_t index, const std::string& label) {
  if (!label.empty()) labels_[path_ + '[' + std::to_string(index) + ']'] = label;
}

std::string Problems::Shown(const std::string& path) const {
  std::string labels;
  size_t end = 0;  // end of the last entry with a label
  for (size_t at = path.find(']'); at != std::string::npos; at = path.find(']', at + 1)) {
    const auto label = labels_.find(path.substr(0, at + 1));
    if (label == labels_.end()) continue;
    labels += (labels.empty() ? "" : " / ") + label->second;
    end = at + 1;
  }
  if (labels.empty()) return path;
  return labels + " (" + path.substr(0, end) + ")" + path.substr(end);
}

std::string Problems::Text(std::string_view what) const {
  constexpr size_t kShown = 50;
  std::string out(what);
  const bool one = list_.size() == 1;
  out += one ? " is not valid: " : " is not valid, " + std::to_string(list_.size()) + " problems:";
  for (size_t i = 0; i < std::min(list_.size(), kShown); ++i) {
    const Problem& p = list_[i];
    if (!one) out += "\n  ";
    if (!p.source.empty()) out += p.source + ": ";
    if (!p.path.empty()) out += Shown(p.path) + ": ";
    out += p.message;
  }
  if (list_.size() > kShown) {
    out += "\n  and " + std::to_string(list_.size() - kShown) + " more";
  }
  return out;
}

void Problems::Throw(std::string_view what) const {
  if (!empty()) throw SpecError(Text(what));
}

}  // namespace robocell
