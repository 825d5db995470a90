// The program robocell_drawing_service, which renderers with back end `gl` start:
//
//   robocell_drawing_service NAME [auto|egl|osmesa]
#include "robocell/render/drawing_service.h"

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: robocell_drawing_service NAME [auto|egl|osmesa]\n", stderr);
    return 2;
  }
  try {
    return robocell::ServeDrawings(argv[1], {.gl = argc > 2 ? argv[2] : "auto"}) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "robocell_drawing_service: %s\n", error.what());
    return 1;
  }
}
