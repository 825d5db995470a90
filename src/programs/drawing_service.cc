// The program robocell_drawing_service, which renderers with back end `gl` start
// (robocell/render/drawing_service.h):
//
//   robocell_drawing_service NAME [auto|egl|osmesa]
namespace robocell {
int DrawingServiceMain(int argc, char** argv);
}

int main(int argc, char** argv) { return robocell::DrawingServiceMain(argc, argv); }
