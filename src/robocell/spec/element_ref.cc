#include "robocell/spec/element_ref.h"

namespace robocell {

std::string Describe(const ElementRef& ref) {
  const std::string kind = ref.kind ? ToString(*ref.kind) : "element";
  if (ref.body.empty()) return kind + " '" + ref.name + "'";
  return kind + " " + std::to_string(ref.index) + " of body '" + ref.body + "'";
}

}  // namespace robocell
