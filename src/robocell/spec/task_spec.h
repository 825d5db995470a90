// TaskSpec: what `task:` of a run file or of an environment says: the kind of task, and the fields
// of that kind.
//
//   task: {kind: pick, base_distance: [0.3, 0.6]}
//
//   run.task = PickTaskConfig{.lift_height = 0.1};
//   if (const auto* pick = run.task.If<PickTaskConfig>()) ...
//
// Each kind has a struct of its own, declared as all specs are (fields.h), and registers it: pick
// and pick_and_place are there, others come with RegisterTaskFields, usually by way of RegisterTask
// (task/task_kind.h). A task written in Python has no C++ struct; its fields are named values
// (value_fields.h). TaskSpec is a value: copies are deep, equal means the same kind and fields.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// What a field of a task may be.
using TaskField =
    std::variant<bool*, int*, int64_t*, double*, std::string*, Vec2*, Vec3*, Vec4*,
                 std::vector<double>*, std::vector<std::string>*, NameList*, Pose*,
                 std::optional<int>*, std::optional<double>*, std::optional<std::string>*,
                 std::optional<Vec2>*, std::optional<Vec3>*, std::optional<Pose>*>;

// One field of a task's struct, for those who know no struct.
struct TaskFieldRef {
  std::string name;
  TaskField value;
  std::string doc;
  Bound bound = Bound::kNone;
};

// The fields of one kind of task, their type hidden.
class TaskFields {
 public:
  virtual ~TaskFields() = default;
  virtual std::shared_ptr<TaskFields> Clone() const = 0;
  virtual std::vector<TaskFieldRef> refs() = 0;
  virtual std::string type_name() const = 0;
  // Checks of the fields together; each by itself is checked already.
  virtual void Validate(Problems& /*problems*/) const {}
  // The struct itself.
  virtual void* value() = 0;
  virtual const std::type_info& type() const = 0;

  std::vector<std::string> names() const;
  // `other` is of the same kind.
  bool Equals(const TaskFields& other) const;
};

// Of a struct that declares its fields.
template <HasFields T>
class TaskFieldsOf final : public TaskFields {
 public:
  std::shared_ptr<TaskFields> Clone() const override {
    return std::make_shared<TaskFieldsOf<T>>(*this);
  }
  std::vector<TaskFieldRef> refs() override {
    std::vector<TaskFieldRef> refs;
    ForEachField(value_, [&](const char* name, auto& value, const char* doc, Bound bound) {
      refs.push_back({name, &value, doc, bound});
    });
    return refs;
  }
  std::string type_name() const override { return T::kTypeName; }
  void Validate(Problems& problems) const override {
    if constexpr (requires { value_.Validate(problems); }) value_.Validate(problems);
  }
  void* value() override { return &value_; }
  const std::type_info& type() const override { return typeid(T); }

 private:
  T value_;
};

// Makes a kind known. `defaults` are copied for each spec of that kind. ArgumentError for a kind
// that is taken, unless `replace` allows it, and for an empty name.
void RegisterTaskFields(const std::string& kind, std::shared_ptr<const TaskFields> defaults,
                        bool replace = false);
// All kinds, in alphabetical order.
std::vector<std::string> TaskKinds();
bool IsTaskKind(const std::string& kind);

// Structs of fields that name their kind.
template <class T>
concept IsTaskConfig = requires {
  { T::kKind } -> std::convertible_to<const char*>;
};

class TaskSpec {
 public:
  // Pick, with its defaults.
  TaskSpec();
  // A kind with its defaults. NotFoundError lists the kinds.
  explicit TaskSpec(const std::string& kind);
  template <IsTaskConfig T>
  TaskSpec(T fields) : TaskSpec(std::string(T::kKind)) {
    *static_cast<T*>(fields_->value()) = std::move(fields);
  }
  // Also what moving does: none is ever without fields.
  TaskSpec(const TaskSpec& other) : kind_(other.kind_), fields_(other.fields_->Clone()) {}
  TaskSpec& operator=(TaskSpec other) {
    kind_ = std::move(other.kind_);
    fields_ = std::move(other.fields_);
    return *this;
  }
  bool operator==(const TaskSpec& other) const {
    return kind_ == other.kind_ && fields_->type() == other.fields_->type() &&
           fields_->Equals(*other.fields_);
  }

  const std::string& kind() const { return kind_; }
  const TaskFields& fields() const { return *fields_; }
  TaskFields& fields() { return *fields_; }
  // For those who keep a reference to the fields: it outlives the spec.
  const std::shared_ptr<TaskFields>& shared_fields() const { return fields_; }

  // The struct when the task is of that type, else null.
  template <class T>
  const T* If() const {
    return fields_->type() == typeid(T) ? static_cast<const T*>(fields_->value()) : nullptr;
  }
  template <class T>
  T* If() {
    return const_cast<T*>(std::as_const(*this).If<T>());
  }
  // The same; SpecError when the task is of another kind.
  template <IsTaskConfig T>
  const T& As() const {
    if (const T* fields = If<T>()) return *fields;
    ThrowOtherKind(T::kKind);
  }
  template <IsTaskConfig T>
  T& As() {
    return const_cast<T&>(std::as_const(*this).As<T>());
  }

 private:
  [[noreturn]] void ThrowOtherKind(const char* wanted) const;

  std::string kind_;
  std::shared_ptr<TaskFields> fields_;
};

// Adds what is wrong with the fields, each by itself and together.
void ValidateTask(const TaskSpec& task, Problems& problems);

}  // namespace robocell
