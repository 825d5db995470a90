#include "robocell/media/ffmpeg.h"

#include <sys/stat.h>
#include <unistd.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <sstream>

#include "robocell/base/error.h"
#include "robocell/base/real_file.h"
#include "robocell/media/child_process.h"

namespace robocell {
namespace {

bool IsProgram(const std::string& path) {
  struct stat file;
  return stat(path.c_str(), &file) == 0 && S_ISREG(file.st_mode) && access(path.c_str(), X_OK) == 0;
}

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string OnPath(const std::string& program) {
  std::istringstream folders(Variable("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string path = (folder.empty() ? "." : folder) + "/" + program;
    if (IsProgram(path)) return path;
  }
  return "";
}

std::string AskVersion(const std::string& program) {
  internal::ChildProcess child({program, "-hide_banner", "-version"},
                               {.pipe_stdout = true, .stall_timeout_s = 20});
  std::string text(4096, '\0');
  text.resize(child.Read({reinterpret_cast<uint8_t*>(text.data()), text.size()}));
  const std::string line = text.substr(0, text.find('\n'));
  if (!line.starts_with("ffmpeg version")) {
    throw IoError(
        fmt::format("'{}' is not ffmpeg: '{} -version' answered '{}'", program, program, line));
  }
  return line.substr(0, line.find(" Copyright"));
}

constexpr char kSeparator = '\t';

// Returns the answer for this file that the parent process handed over; "" if there is none.
std::string HandedOver(const std::string& file) {
  const std::string answer = Variable("ROBOCELL_FFMPEG_ANSWER");
  const std::string beginning = file + kSeparator;
  return answer.starts_with(beginning) ? answer.substr(beginning.size()) : "";
}

struct Answers {
  std::mutex mutex;
  std::map<std::string, std::string> known;  // identity of a file -> version
  std::string last;
};

Answers& answers() {
  static Answers all;
  return all;
}

}  // namespace

std::string FindFfmpeg() {
  const std::string chosen = Variable("ROBOCELL_FFMPEG");
  if (!chosen.empty()) {
    if (IsProgram(chosen)) return chosen;
    throw IoError(fmt::format(
        "ROBOCELL_FFMPEG is '{}', which is not an executable file. Correct or unset it.", chosen));
  }
  if (const std::string found = OnPath("ffmpeg"); !found.empty()) return found;
  const std::string packaged = Variable("IMAGEIO_FFMPEG_EXE");
  if (IsProgram(packaged)) return packaged;
  throw IoError(
      fmt::format("no ffmpeg found for video: ROBOCELL_FFMPEG is not set, PATH ({}) has none, "
                  "IMAGEIO_FFMPEG_EXE is {}. "
                  "Install it (Debian, Ubuntu: apt install ffmpeg), or pip install imageio-ffmpeg "
                  "and set ROBOCELL_FFMPEG to "
                  "what imageio_ffmpeg.get_ffmpeg_exe() returns.",
                  Variable("PATH"),
                  packaged.empty() ? "not set" : "'" + packaged + "', not an executable file"));
}

std::string FfmpegVersion(const std::string& program) {
  Answers& all = answers();
  const std::lock_guard lock(all.mutex);
  const std::string file = internal::FileIdentity(program);
  auto found = all.known.find(file);
  if (found == all.known.end()) {
    std::string version = HandedOver(file);
    if (version.empty()) version = AskVersion(program);
    found = all.known.emplace(file, std::move(version)).first;
  }
  all.last = file + kSeparator + found->second;
  return found->second;
}

std::string FfmpegAnswer() {
  Answers& all = answers();
  const std::lock_guard lock(all.mutex);
  return all.last;
}

}  // namespace robocell
