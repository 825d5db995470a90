#include "robocell/base/function_name.h"

namespace robocell::internal {
namespace {

bool IsUpper(char c) { return c >= 'A' && c <= 'Z'; }

std::string SnakeCase(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (IsUpper(c) && !out.empty()) out += '_';
    out += IsUpper(c) ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

}  // namespace

std::string CppAndPythonName(std::string_view function) {
  constexpr std::string_view kOf = "::";
  const size_t of = function.rfind(kOf);
  std::string python;
  if (of != std::string_view::npos) python = std::string(function.substr(0, of)) + ".";
  python += SnakeCase(of == std::string_view::npos ? function : function.substr(of + kOf.size()));
  return std::string(function) + " (in Python " + python + ")";
}

}  // namespace robocell::internal
