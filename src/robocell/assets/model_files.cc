#include "robocell/assets/model_files.h"

#include <cctype>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

#include "robocell/base/files.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

bool IsName(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::string WithoutComments(std::string text) {
  for (size_t begin = 0; (begin = text.find("<!--", begin)) != std::string::npos;) {
    const size_t end = text.find("-->", begin);
    text.erase(begin, end == std::string::npos ? end : end + 3 - begin);
  }
  return text;
}

// Calls f(attribute, value) for everything that reads like an XML attribute.
template <class F>
void ForEachAttribute(std::string_view text, F&& f) {
  for (size_t equals = text.find('='); equals != std::string_view::npos;
       equals = text.find('=', equals + 1)) {
    size_t end = equals;
    while (end > 0 && std::isspace(static_cast<unsigned char>(text[end - 1]))) --end;
    size_t begin = end;
    while (begin > 0 && IsName(text[begin - 1])) --begin;
    const size_t open = text.find_first_not_of(" \t\r\n", equals + 1);
    if (begin == end || open == std::string_view::npos) continue;
    if (text[open] != '"' && text[open] != '\'') continue;
    const size_t close = text.find(text[open], open + 1);
    if (close == std::string_view::npos) return;
    f(text.substr(begin, end - begin), text.substr(open + 1, close - open - 1));
    equals = close;
  }
}

// Walks from the model to all that it names.
class Walk {
 public:
  explicit Walk(fs::path model) : folder_(model.parent_path()) { Read(std::move(model)); }

  std::map<std::string, fs::path> Named() const {
    std::map<std::string, fs::path> named;
    for (const fs::path& file : files_) {
      const fs::path inside = file.lexically_relative(folder_);
      named[(folder_.filename() / inside).lexically_normal().generic_string()] = file;
    }
    return named;
  }
  std::vector<fs::path> files() const { return {files_.begin(), files_.end()}; }

 private:
  void Read(fs::path file) {
    file = file.lexically_normal();
    if (!files_.insert(file).second || file.extension() != ".xml") return;
    const std::string text = WithoutComments(ReadFile(file));
    std::vector<fs::path> names;
    ForEachAttribute(text, [&](std::string_view attribute, std::string_view value) {
      if (attribute == "meshdir" || attribute == "texturedir" || attribute == "assetdir")
        folders_.insert(fs::path(value));
      if (attribute.starts_with("file") && !value.empty()) names.emplace_back(value);
    });
    for (const fs::path& name : names) ReadWhereItIs(file.parent_path(), name);
  }

  // In the model's folder, the including file's, or one of its asset folders, with and without the
  // folder that is written (the compiler's strippath).
  void ReadWhereItIs(const fs::path& including, const fs::path& name) {
    std::set<fs::path> folders = {folder_, including};
    for (const fs::path& asset : folders_) folders.insert(folder_ / asset);
    for (const fs::path& folder : folders) {
      for (const fs::path& written : {name, name.filename()}) {
        std::error_code error;
        if (fs::is_regular_file(folder / written, error)) Read(folder / written);
      }
    }
  }

  fs::path folder_;
  std::set<fs::path> folders_;  // of assets, as written
  std::set<fs::path> files_;
};

}  // namespace

std::map<std::string, fs::path> ModelFiles(const fs::path& model) {
  return Walk(fs::absolute(model).lexically_normal()).Named();
}

FileSet ModelFileSet(const fs::path& model) {
  const fs::path absolute = fs::absolute(model).lexically_normal();
  return MakeFileSet(absolute, Walk(absolute).files());
}

}  // namespace robocell
