// Finds the ffmpeg program and its version. It runs as a child process and is never linked, so that
// its licence (GPL in most builds) stays its own.
#pragma once

#include <string>

namespace robocell {

// Returns the program to use: ROBOCELL_FFMPEG if set (then nothing else is tried), else `ffmpeg` on
// PATH, else IMAGEIO_FFMPEG_EXE (the binary of the imageio-ffmpeg package). Throws IoError with the
// tried paths if there is none.
std::string FindFfmpeg();

// Returns "ffmpeg version 5.1.9-0+deb12u1": the first line of `program -version` up to the
// copyright. It runs once per program file, because starting ffmpeg takes a tenth of a second. The
// same frames give the same bytes only with the same version.
std::string FfmpegVersion(const std::string& program = FindFfmpeg());

// Returns the last result of FfmpegVersion as the value of ROBOCELL_FFMPEG_ANSWER for child
// processes, so that they need not run the same file again. "" if it was not called.
std::string FfmpegAnswer();

}  // namespace robocell
