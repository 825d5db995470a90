// KindFields and KindSpec: a part of a configuration whose fields depend on a kind that it names,
// as `task: {kind: pick, ...}` and `scenes: {source: files, ...}`.
//
// Each kind has a struct of its own, declared as all specs are (fields.h), in a registry of its
// sort (TaskKindRegistry() in task_spec.h, SceneSourceRegistry() in scene_source_spec.h). The layers
// that know the kinds define these registries; this one knows none. Kinds written in Python have no
// C++ struct; their fields are named values (value_fields.h). A KindSpec is a value: copies are
// deep, equal means the same kind and fields.
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "robocell/base/registry.h"
#include "robocell/math/pose.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

struct EnvConfig;
struct RunConfig;

// The types that a field of a kind can have.
using KindField =
    std::variant<bool*, int*, int64_t*, double*, std::string*, Vec2*, Vec3*, Vec4*,
                 std::vector<double>*, std::vector<std::string>*, NameList*, Pose*,
                 std::optional<int>*, std::optional<double>*, std::optional<std::string>*,
                 std::optional<Vec2>*, std::optional<Vec3>*, std::optional<Pose>*>;

// A field of a kind's struct, for code that does not know the struct.
struct KindFieldRef {
  std::string name;
  KindField value;
  std::string doc;
  Bound bound = Bound::kNone;
};

// The fields of one kind, without their type.
class KindFields {
 public:
  virtual ~KindFields() = default;
  virtual std::shared_ptr<KindFields> Clone() const = 0;
  virtual std::vector<KindFieldRef> refs() = 0;
  virtual std::string type_name() const = 0;
  // Checks the fields together; each by itself is already checked.
  virtual void Validate(Problems& /*problems*/) const {}
  // Returns the struct itself.
  virtual void* value() = 0;
  virtual const std::type_info& type() const = 0;

  std::vector<std::string> names() const;
  // Requires `other` to be of the same kind.
  bool Equals(const KindFields& other) const;
};

// The fields of a struct that declares them.
template <HasFields T>
class KindFieldsOf final : public KindFields {
 public:
  std::shared_ptr<KindFields> Clone() const override {
    return std::make_shared<KindFieldsOf<T>>(*this);
  }
  std::vector<KindFieldRef> refs() override {
    std::vector<KindFieldRef> refs;
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

// Structs of fields that name their kind.
template <class T>
concept NamesItsKind = requires {
  { T::kKind } -> std::convertible_to<const char*>;
};

// The checks of a kind on configurations that name it, beside its fields. Each sort of kinds has
// a class of its own (TaskKind, SceneSourceKind).
class KindRules {
 public:
  virtual ~KindRules() = default;
  // Check the fields of the kind in a run or an environment: what belongs to the other of the two,
  // what is required there, names of what is not there. Each field by itself is already checked.
  // Problems are added at the paths of the configuration, such as task.object.
  virtual void ValidateRun(const RunConfig& /*run*/, Problems& /*problems*/) const {}
  virtual void ValidateEnv(const EnvConfig& /*env*/, Problems& /*problems*/) const {}
};

// A kind: the defaults of its fields, and its rules.
struct RegisteredKind {
  std::shared_ptr<const KindFields> fields;
  std::shared_ptr<const KindRules> rules;
};

// The kinds of one sort by name. Any thread may use it.
class KindRegistry {
 public:
  using Kinds = std::map<std::string, RegisteredKind>;

  // `noun` is the word for the sort in messages, `key` the field that names a kind, and
  // `default_kind` the kind of a configuration that names none.
  KindRegistry(const char* noun, const char* key, std::string default_kind, Kinds kinds)
      : key_(key), default_kind_(std::move(default_kind)), kinds_(noun, std::move(kinds)) {}

  // Registers a kind. Its fields are copied for each spec of that kind. Throws ArgumentError for an
  // empty name, without fields or rules, and for a kind that is taken unless `replace` allows it.
  void Register(const std::string& kind, RegisteredKind registered, bool replace);
  // Returns all kinds in alphabetical order.
  std::vector<std::string> kinds() const { return kinds_.names(); }
  bool Has(const std::string& kind) const { return kinds_.Has(kind); }
  // Returns a copy of the defaults. Throws NotFoundError that lists the kinds.
  std::shared_ptr<KindFields> Make(const std::string& kind) const;
  // Throws NotFoundError that lists the kinds.
  std::shared_ptr<const KindRules> RulesOf(const std::string& kind) const {
    return kinds_.Find(kind).rules;
  }
  // Returns the first kind with a field of this name; "" if there is none.
  std::string KindWith(const std::string& field) const;
  const std::string& default_kind() const { return default_kind_; }
  const char* noun() const { return kinds_.noun(); }
  const char* key() const { return key_; }

 private:
  const char* key_;
  std::string default_kind_;
  Registry<RegisteredKind> kinds_;
};

class KindSpec {
 public:
  // Moving copies too: no spec is ever without fields.
  KindSpec(const KindSpec& other)
      : registry_(other.registry_), kind_(other.kind_), fields_(other.fields_->Clone()) {}
  KindSpec& operator=(const KindSpec& other) {
    if (this == &other) return *this;
    kind_ = other.kind_;
    fields_ = other.fields_->Clone();
    return *this;
  }
  bool operator==(const KindSpec& other) const {
    return kind_ == other.kind_ && fields_->type() == other.fields_->type() &&
           fields_->Equals(*other.fields_);
  }

  const std::string& kind() const { return kind_; }
  // Changes the kind and sets the fields to its defaults. Throws NotFoundError that lists the
  // kinds.
  void SetKind(const std::string& kind);
  const KindRegistry& registry() const { return *registry_; }
  std::shared_ptr<const KindRules> rules() const { return registry_->RulesOf(kind_); }
  const KindFields& fields() const { return *fields_; }
  KindFields& fields() { return *fields_; }
  // Returns a reference to the fields that outlives the spec.
  const std::shared_ptr<KindFields>& shared_fields() const { return fields_; }

  // Returns the struct if the fields have that type, else null.
  template <class T>
  const T* If() const {
    return fields_->type() == typeid(T) ? static_cast<const T*>(fields_->value()) : nullptr;
  }
  template <class T>
  T* If() {
    return const_cast<T*>(std::as_const(*this).If<T>());
  }
  // Returns the fields as T; throws SpecError for another kind.
  template <NamesItsKind T>
  const T& As() const {
    if (const T* fields = If<T>()) return *fields;
    ThrowOtherKind(T::kKind);
  }
  template <NamesItsKind T>
  T& As() {
    return const_cast<T&>(std::as_const(*this).As<T>());
  }

 protected:
  // Makes a kind with its defaults. Throws NotFoundError that lists the kinds.
  KindSpec(const KindRegistry& registry, const std::string& kind)
      : registry_(&registry), kind_(kind), fields_(registry.Make(kind)) {}
  template <NamesItsKind T>
  void Put(T fields) {
    *static_cast<T*>(fields_->value()) = std::move(fields);
  }

 private:
  [[noreturn]] void ThrowOtherKind(const char* wanted) const;

  const KindRegistry* registry_;
  std::string kind_;
  std::shared_ptr<KindFields> fields_;
};

// Adds the problems of the fields, each by itself and together.
void ValidateKind(const KindSpec& spec, Problems& problems);

}  // namespace robocell
