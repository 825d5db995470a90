// Registry: what is known by name, such as kinds of tasks, experts and controllers: the built-in ones
// and those that users register. All threads share it.
//
//   Registry<std::shared_ptr<const ExpertKind>> registry("expert", {{"pick", MakePickExpert()}});
//   registry.Register("stack", kind, /*replace=*/false);
//   registry.Find("stak");  // NotFoundError: lists the names, the nearest first
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {

template <class T>
class Registry {
 public:
  // `noun` is the word for an entry in messages.
  explicit Registry(const char* noun, std::map<std::string, T> entries = {})
      : noun_(noun), entries_(std::move(entries)) {}

  // Throws ArgumentError for an empty name, and for one that is taken unless `replace` allows it.
  void Register(const std::string& name, T entry, bool replace) {
    if (name.empty())
      throw ArgumentError(std::string("a kind of ") + noun_ + " that is registered needs a name");
    const std::lock_guard lock(mutex_);
    if (entries_.contains(name) && !replace) {
      throw ArgumentError(std::string(noun_) + " '" + name +
                          "' is registered already; choose another name");
    }
    entries_[name] = std::move(entry);
  }
  // Returns all names in alphabetical order.
  std::vector<std::string> names() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const auto& [name, entry] : entries_) names.push_back(name);
    return names;
  }
  bool Has(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    return entries_.contains(name);
  }
  // Returns a copy of the entry; unset if there is none.
  std::optional<T> Get(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(name);
    return found == entries_.end() ? std::nullopt : std::optional<T>(found->second);
  }
  // Returns a copy of the entry. Throws NotFoundError, which begins with `place` and lists the
  // names.
  T Find(const std::string& name, const std::string& place = "") const {
    if (std::optional<T> entry = Get(name)) return *std::move(entry);
    throw NotFoundError(NoSuchName(place, noun_, name, names()));
  }
  const char* noun() const { return noun_; }

 private:
  const char* noun_;
  mutable std::mutex mutex_;
  std::map<std::string, T> entries_;
};

}  // namespace robocell
