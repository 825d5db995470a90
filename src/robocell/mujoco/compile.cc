#include "robocell/mujoco/compile.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <type_traits>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/engine_exception.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/parse_problem.h"
#include "robocell/mujoco/warnings.h"

namespace robocell {
namespace {

using Path = std::filesystem::path;

std::string Prefix(std::string_view context) {
  return context.empty() ? "" : std::string(context) + ": ";
}

std::string Trim(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string Joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += (out.empty() ? "" : "; ") + line;
  return out;
}

// Returns ". Models in 'cells': a.xml, b.xml. Did you mean 'a.xml'?" for a missing file.
std::string ModelsBeside(const Path& path) {
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  std::vector<std::string> names = FolderNamesIfAny(folder);
  std::erase_if(names, [](const Path& name) { return name.extension() != ".xml"; });
  if (names.empty()) return "";
  return ". Models in '" + folder.string() + "': " + ListNames(names) + "." +
         DidYouMean(path.filename().string(), names);
}

void RequireReadableModel(const Path& path, std::string_view context) {
  std::error_code error;
  // A pipe or a device is not even opened: that may wait for ever.
  if (std::filesystem::exists(path, error) && !internal::CanReadFile(path)) {
    throw IoError(Prefix(context) + "'" + path.string() + "' is " + internal::WhatIsAt(path) +
                  ", not a model file");
  }
  if (!std::ifstream(path)) {
    const std::string why = std::strerror(errno);
    const bool missing = errno == ENOENT;
    throw IoError(Prefix(context) + "cannot read model file '" + path.string() + "': " + why +
                  (missing ? ModelsBeside(path) : ""));
  }
}

// Runs a file operation and adds its purpose to an error.
template <class Function>
auto InContext(std::string_view context, Function fn) {
  try {
    return fn();
  } catch (const IoError& error) {
    throw IoError(Prefix(context) + error.what());
  }
}

void Report(const std::vector<std::string>& found, std::string_view context,
            std::vector<std::string>* warnings) {
  for (const std::string& text : found) {
    if (warnings) {
      warnings->push_back(text);
    } else {
      LogWarn(Prefix(context) + "MuJoCo: " + text);
    }
  }
}

bool Guard(mjModel* model, std::string_view context) {
  const bool guarded = GuardJacobian(model);
  if (guarded) LogJacobianGuard(model, context);
  return guarded;
}

// `file` is "" for a text.
template <class Parse>
SpecPtr Parsed(Parse parse, const std::string& file, std::string_view context) {
  std::array<char, 2048> error{};
  const std::string place =
      Prefix(context) + (file.empty() ? "model text" : "model file '" + file + "'");
  const internal::WarningCapture captured;  // for a file that they do not name
  SpecPtr spec(
      internal::Tried(place, [&] { return parse(error.data(), static_cast<int>(error.size())); }));
  const std::string begin = file.empty() ? place + ": " : Prefix(context);
  if (!spec) throw SpecError(begin + internal::ParseProblem(Trim(error.data()), file));
  for (const std::string& text : captured.messages()) {
    if (internal::IsAboutNan(text)) throw SpecError(begin + internal::NanProblem(file));
    LogWarn(fmt::format("{}: MuJoCo: {}", place, text));
  }
  return spec;
}

}  // namespace

SpecPtr ParseXmlFile(const Path& path, std::string_view context, mjVFS* vfs) {
  const std::string file = path.string();
  if (!vfs || !mj_containsFileVFS(vfs, "", file.c_str())) RequireReadableModel(path, context);
  return Parsed([&](char* error, int size) { return mj_parseXML(file.c_str(), vfs, error, size); },
                file, context);
}

SpecPtr ParseXmlString(const std::string& xml, std::string_view context, mjVFS* vfs) {
  return Parsed(
      [&](char* error, int size) { return mj_parseXMLString(xml.c_str(), vfs, error, size); }, "",
      context);
}

ModelPtr Compile(mjSpec* spec, mjVFS* vfs, std::string_view context,
                 std::vector<std::string>* warnings, JacobianGuard guard) {
  spec->option.disableflags |= mjDSBL_AUTORESET;
  const std::string place = Prefix(context) + "building the model";
  internal::WarningCapture
      replayed;  // the engine repeats the spec's warnings in the log; they are read below
  ModelPtr model(internal::Tried(place, [&] { return mj_compile(spec, vfs); }));
  if (!model) throw SpecError(place + ": " + Trim(mjs_getError(spec)));
  const std::string problem = internal::NonFiniteElement(model.get());
  if (!problem.empty()) throw SpecError(place + ": " + problem);
  Report(SpecWarnings(spec), context, warnings);
  if (guard == JacobianGuard::kOn && Guard(model.get(), context))
    spec->option.jacobian = model->opt.jacobian;
  return model;
}

std::string SaveXmlString(const mjSpec* spec, std::string_view context) {
  const std::string place = Prefix(context) + "saving as XML";
  std::array<char, 2048> error{};
  std::string xml(1 << 16, '\0');
  for (;;) {
    const int rc = internal::Tried(place, [&] {
      return mj_saveXMLString(spec, xml.data(), static_cast<int>(xml.size()), error.data(),
                              static_cast<int>(error.size()));
    });
    if (rc < 0) throw EngineError(place + ": " + Trim(error.data()));
    if (rc == 0) return xml.c_str();
    xml.resize(static_cast<size_t>(rc) + 1);
  }
}

void SaveXml(const mjSpec* spec, const Path& path, std::string_view context) {
  const std::string xml = SaveXmlString(spec, context);
  InContext(context, [&] { AtomicWrite(path, xml); });
}

std::string SaveBinaryString(const mjModel* model) {
  std::string bytes(static_cast<size_t>(mj_sizeModel(model)), '\0');
  internal::Tried("saving a model as binary", [&] {
    mj_saveModel(model, nullptr, bytes.data(), static_cast<mjtSize>(bytes.size()));
  });
  return bytes;
}

void SaveBinary(const mjModel* model, const Path& path, std::string_view context) {
  const std::string bytes = SaveBinaryString(model);
  InContext(context, [&] { AtomicWrite(path, bytes); });
}

ModelPtr LoadBinaryString(std::string_view bytes, std::string_view context, JacobianGuard guard) {
  const std::string place = Prefix(context) + "loading a binary model";
  internal::WarningCapture reasons;
  ModelPtr model(internal::Tried(
      place, [&] { return mj_loadModelBuffer(bytes.data(), static_cast<mjtSize>(bytes.size())); }));
  if (!model) throw SpecError(place + ": " + Joined(reasons.messages()));
  model->opt.disableflags |= mjDSBL_AUTORESET;
  if (guard == JacobianGuard::kOn) Guard(model.get(), context);
  return model;
}

ModelPtr LoadBinary(const Path& path, std::string_view context, JacobianGuard guard) {
  constexpr uint64_t kMost = uint64_t{8} << 30;
  const std::string bytes = InContext(context, [&] { return internal::ReadRealFile(path, kMost); });
  return LoadBinaryString(bytes, Prefix(context) + "'" + path.string() + "'", guard);
}

}  // namespace robocell
