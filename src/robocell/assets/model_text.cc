#include "robocell/assets/model_text.h"

#include <strings.h>
#include <tinyxml2.h>

#include <algorithm>

namespace robocell::assets {
namespace {

using tinyxml2::XMLElement;

std::string WithSlashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

bool Is(const XMLElement& element, const char* name) {
  return ::strcasecmp(element.Name(), name) == 0;
}

NameKind KindOf(const XMLElement& element) {
  if (Is(element, "include")) return NameKind::kInclude;
  return Is(element, "model") ? NameKind::kModel : NameKind::kAsset;
}

// All elements alike: what else may name files in the next engine is found, too.
void ReadAttributes(const XMLElement& element, ModelText& text) {
  for (const auto* it = element.FirstAttribute(); it; it = it->Next()) {
    const std::string_view attribute = it->Name();
    const std::string value = WithSlashes(it->Value());
    if (attribute == "meshdir" || attribute == "texturedir" || attribute == "assetdir")
      text.folders.push_back(value);
    if (attribute == "strippath") text.strips_paths |= value == "true";
    if (attribute.starts_with("file") && !value.empty())
      text.names.push_back({KindOf(element), value});
  }
}

void ReadElements(const XMLElement& element, ModelText& text) {
  ReadAttributes(element, text);
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    ReadElements(*child, text);
}

}  // namespace

ModelText ReadModelText(std::string_view xml) {
  ModelText text;
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    text.problem = document.ErrorStr();
  } else if (const XMLElement* root = document.RootElement()) {
    text.strips_paths = Is(*root, "robot");  // URDF
    ReadElements(*root, text);
  } else {
    text.problem = "it has no element";
  }
  return text;
}

}  // namespace robocell::assets
