// Prints the methods that can be chosen by name.

#include <cstdio>

#include "diminish/diminish.h"

int main() {
  std::printf("colour correction: %s\n",
              diminish::Registry<diminish::ColorCorrector>::known().c_str());
  std::printf("inpainting: %s\n", diminish::Registry<diminish::Inpainter>::known().c_str());
  std::printf("view mode: %s\n", diminish::Registry<diminish::ViewMode>::known().c_str());
  std::printf("reconstruction: %s\n", diminish::Registry<diminish::Reconstructor>::known().c_str());
}
