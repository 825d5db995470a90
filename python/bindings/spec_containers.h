// List<T> and Map<T> of specs as Python's mutable sequence and mapping. The Python objects are
// views: they hold the spec that the container belongs to, and every change applies to the spec. A
// table of functions hides the type of the elements.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bindings.h"
#include "values.h"

namespace robocell::python {

using AnyBox = std::shared_ptr<void>;

struct ListOps {
  const char* element;  // "RobotSpec"
  size_t (*size)(const void* list);
  nb::object (*get)(void* list, size_t i);
  AnyBox (*box)(nb::handle value, const FieldPath& path);
  // Replaces `count` elements from `at` on.
  void (*splice)(void* list, size_t at, size_t count, const std::vector<AnyBox>& boxes);
  bool (*equal)(const void* a, const void* b);
};

struct MapOps {
  const char* element;  // "Pose", "numbers"
  size_t (*size)(const void* map);
  std::string (*key)(const void* map, size_t i);
  // `name` is that of the map, for messages.
  nb::object (*get)(void* map, size_t i, const std::string& name);
  AnyBox (*box)(nb::handle value, const FieldPath& path);
  void (*set)(void* map, const std::string& key, const AnyBox& box);
  void (*erase)(void* map, size_t i);
  bool (*equal)(const void* a, const void* b);
};

struct SpecList {
  nb::object owner;
  std::string name;  // name of the field, for messages
  void* list;
  const ListOps* ops;
};

struct SpecMap {
  nb::object owner;
  std::string name;
  void* map;
  const MapOps* ops;
};

// Replaces all elements, as in `spec.robots = [...]`. If one is rejected, nothing changes.
void AssignList(void* list, const ListOps& ops, nb::handle value, const FieldPath& path);
void AssignMap(void* map, const MapOps& ops, nb::handle value, const FieldPath& path);

void BindSpecContainers(nb::module_& m);

}  // namespace robocell::python
