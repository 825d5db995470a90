// Containers of specs. Elements live in boxes: copying the container copies them deeply, and an
// element keeps its address when the container grows, so that Python can hold and edit it in place.
//
//   List<RobotSpec> robots;
//   robots.push_back({.path = "arm.xml", .prefix = "left_"});
//   robots[0].prefix = "right_";
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {

// A value that is stored in its own allocation and copied deeply.
template <class T>
using Box = std::shared_ptr<T>;

template <class T>
class List {
 public:
  using value_type = T;

  List() = default;
  List(std::initializer_list<T> values) {
    for (const T& value : values) push_back(value);
  }
  List(const List& other) { *this = other; }
  List(List&&) noexcept = default;
  List& operator=(const List& other) {
    std::vector<Box<T>> copies;
    copies.reserve(other.boxes_.size());
    for (const Box<T>& box : other.boxes_) copies.push_back(std::make_shared<T>(*box));
    boxes_ = std::move(copies);
    return *this;
  }
  List& operator=(List&&) noexcept = default;

  size_t size() const { return boxes_.size(); }
  bool empty() const { return boxes_.empty(); }
  void clear() { boxes_.clear(); }
  T& operator[](size_t i) { return *boxes_[i]; }
  const T& operator[](size_t i) const { return *boxes_[i]; }
  T& back() { return *boxes_.back(); }
  const T& back() const { return *boxes_.back(); }
  T& push_back(T value) { return *boxes_.emplace_back(std::make_shared<T>(std::move(value))); }

  // The boxes themselves, for Python: an element that is put in stays the same object.
  std::vector<Box<T>>& boxes() { return boxes_; }
  const std::vector<Box<T>>& boxes() const { return boxes_; }

  template <class Inner, class Value>
  struct Iterator {
    Inner it;
    Value& operator*() const { return **it; }
    Value* operator->() const { return it->get(); }
    Iterator& operator++() { return ++it, *this; }
    bool operator==(const Iterator& o) const { return it == o.it; }
  };
  auto begin() { return Iterator<typename std::vector<Box<T>>::iterator, T>{boxes_.begin()}; }
  auto end() { return Iterator<typename std::vector<Box<T>>::iterator, T>{boxes_.end()}; }
  auto begin() const {
    return Iterator<typename std::vector<Box<T>>::const_iterator, const T>{boxes_.begin()};
  }
  auto end() const {
    return Iterator<typename std::vector<Box<T>>::const_iterator, const T>{boxes_.end()};
  }

  bool operator==(const List& other) const {
    if (size() != other.size()) return false;
    for (size_t i = 0; i < size(); ++i) {
      if (!((*this)[i] == other[i])) return false;
    }
    return true;
  }

 private:
  std::vector<Box<T>> boxes_;
};

// Names to specs, in the order of insertion.
template <class T>
class Map {
 public:
  using mapped_type = T;
  using Entry = std::pair<std::string, Box<T>>;

  Map() = default;
  Map(std::initializer_list<std::pair<std::string, T>> values) {
    for (const auto& [key, value] : values) (*this)[key] = value;
  }
  Map(const Map& other) { *this = other; }
  Map(Map&&) noexcept = default;
  Map& operator=(const Map& other) {
    std::vector<Entry> copies;
    for (const auto& [key, box] : other.entries_)
      copies.emplace_back(key, std::make_shared<T>(*box));
    entries_ = std::move(copies);
    return *this;
  }
  Map& operator=(Map&&) noexcept = default;

  size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  void clear() { entries_.clear(); }
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  const T* find(std::string_view key) const {
    for (const auto& [k, box] : entries_) {
      if (k == key) return box.get();
    }
    return nullptr;
  }
  T* find(std::string_view key) { return const_cast<T*>(std::as_const(*this).find(key)); }
  // Adds an empty value if the key is new.
  T& operator[](std::string_view key) {
    if (T* value = find(key)) return *value;
    return *entries_.emplace_back(std::string(key), std::make_shared<T>()).second;
  }
  // Throws NotFoundError with the nearest keys if the key is absent.
  const T& at(std::string_view key) const {
    if (const T* value = find(key)) return *value;
    throw NotFoundError(NoSuchName("", "entry", key, keys()));
  }
  T& at(std::string_view key) { return const_cast<T&>(std::as_const(*this).at(key)); }
  std::vector<std::string> keys() const {
    std::vector<std::string> out;
    for (const auto& [key, box] : entries_) out.push_back(key);
    return out;
  }

  std::vector<Entry>& entries() { return entries_; }
  const std::vector<Entry>& entries() const { return entries_; }

  bool operator==(const Map& other) const {
    if (size() != other.size()) return false;
    for (size_t i = 0; i < size(); ++i) {
      if (entries_[i].first != other.entries_[i].first ||
          !(*entries_[i].second == *other.entries_[i].second))
        return false;
    }
    return true;
  }

 private:
  std::vector<Entry> entries_;
};

// A spec that may be unset: like std::optional, but allocated separately, so that Python can hold
// and edit the value while the field is assigned or unset.
template <class T>
class Maybe {
 public:
  using value_type = T;

  Maybe() = default;
  Maybe(std::nullopt_t) {}
  Maybe(T value) : box_(std::make_shared<T>(std::move(value))) {}
  Maybe(const Maybe& other) { *this = other; }
  Maybe(Maybe&&) noexcept = default;
  Maybe& operator=(const Maybe& other) {
    if (this == &other) return *this;
    box_ = other.box_ ? std::make_shared<T>(*other.box_) : nullptr;
    return *this;
  }
  Maybe& operator=(Maybe&&) noexcept = default;

  bool has_value() const { return box_ != nullptr; }
  explicit operator bool() const { return has_value(); }
  T& operator*() { return *box_; }
  const T& operator*() const { return *box_; }
  T* operator->() { return box_.get(); }
  const T* operator->() const { return box_.get(); }
  T value_or(T other) const { return box_ ? *box_ : std::move(other); }
  T& emplace() { return *(box_ = std::make_shared<T>()); }
  void reset() { box_.reset(); }

  Box<T>& box() { return box_; }
  const Box<T>& box() const { return box_; }

  bool operator==(const Maybe& other) const {
    return box_ && other.box_ ? *box_ == *other.box_ : !box_ && !other.box_;
  }

 private:
  Box<T> box_;
};

// A list of names; in YAML a single name, a list, or a numbered range `joint1..joint7`.
struct NameList {
  std::vector<std::string> names;

  NameList() = default;
  NameList(std::initializer_list<std::string> list) : names(list) {}
  NameList(std::vector<std::string> list) : names(std::move(list)) {}
  // Expands "joint1..joint7"; a name without ".." stands for itself. Throws ArgumentError for a
  // range without numbers.
  static NameList Expand(std::string_view text);

  size_t size() const { return names.size(); }
  bool empty() const { return names.empty(); }
  const std::string& operator[](size_t i) const { return names[i]; }
  auto begin() const { return names.begin(); }
  auto end() const { return names.end(); }
  bool operator==(const NameList&) const = default;
};

}  // namespace robocell
