// Finds the ffmpeg program and its version. It is run as a child process and never linked: its
// licence (GPL in most builds) stays its own.
#pragma once

#include <string>

namespace robocell {

// The program to use: ROBOCELL_FFMPEG if set (then nothing else is tried), else `ffmpeg` on PATH,
// else IMAGEIO_FFMPEG_EXE (the binary of the imageio-ffmpeg package). IoError naming what was tried
// if there is none.
std::string FindFfmpeg();

// "ffmpeg version 5.1.9-0+deb12u1": the first line of `program -version` up to the copyright. Asked
// once per program file: its start takes a tenth of a second. The same frames give the same bytes
// only with the same version.
std::string FfmpegVersion(const std::string& program = FindFfmpeg());

// Returns the last result of FfmpegVersion as the value of ROBOCELL_FFMPEG_ANSWER for child
// processes, so that they need not ask for the same file again. "" if ffmpeg was not asked.
std::string FfmpegAnswer();

}  // namespace robocell
