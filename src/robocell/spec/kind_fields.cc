#include "robocell/spec/kind_fields.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/spec/validate.h"

namespace robocell {

std::vector<std::string> KindFields::names() const {
  std::vector<std::string> names;
  for (const KindFieldRef& field : const_cast<KindFields*>(this)->refs())
    names.push_back(field.name);
  return names;
}

bool KindFields::Equals(const KindFields& other) const {
  const auto mine = const_cast<KindFields*>(this)->refs();
  const auto others = const_cast<KindFields&>(other).refs();
  if (mine.size() != others.size()) return false;
  for (size_t i = 0; i < mine.size(); ++i) {
    if (mine[i].name != others[i].name || mine[i].value.index() != others[i].value.index())
      return false;
    const bool equal = std::visit(
        [&](const auto* value) {
          return *value == *std::get<std::remove_const_t<std::remove_pointer_t<decltype(value)>>*>(
                               others[i].value);
        },
        mine[i].value);
    if (!equal) return false;
  }
  return true;
}

void KindRegistry::Register(const std::string& kind, RegisteredKind registered, bool replace) {
  if (!kind.empty() && (!registered.fields || !registered.rules)) {
    throw ArgumentError(fmt::format(
        "{} '{}' is registered without its {}", noun(), kind,
        registered.fields
            ? "rules; give what makes it, or KindRules where nothing depends on the kind"
            : "fields; give the defaults, such as KindFieldsOf<T>, or those of a struct without "
              "fields"));
  }
  kinds_.Register(kind, std::move(registered), replace);
}

std::shared_ptr<KindFields> KindRegistry::Make(const std::string& kind) const {
  return kinds_.Find(kind).fields->Clone();
}

std::string KindRegistry::KindWith(const std::string& field) const {
  for (const std::string& kind : kinds()) {
    const std::vector<std::string> names = kinds_.Find(kind).fields->names();
    if (std::ranges::find(names, field) != names.end()) return kind;
  }
  return "";
}

void KindSpec::SetKind(const std::string& kind) {
  fields_ = registry_->Make(kind);
  kind_ = kind;
}

void KindSpec::ThrowOtherKind(const char* wanted) const {
  throw SpecError(fmt::format("{}: is of kind {}, where fields of {} are needed", registry_->noun(),
                              kind_, wanted));
}

void ValidateKind(const KindSpec& spec, Problems& problems) {
  KindFields& fields = *spec.shared_fields();
  for (const KindFieldRef& field : fields.refs()) {
    const Problems::Scope scope(problems, field.name);
    std::visit([&](const auto* value) { ValidateValue(*value, field.bound, problems); },
               field.value);
  }
  fields.Validate(problems);
}

}  // namespace robocell
