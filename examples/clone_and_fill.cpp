// The membrane alone, on plain bytes: clones a patch of another exposure into a picture without a
// seam, and fills a hole at the picture's border.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "diminish/membrane.h"

namespace {

constexpr int width = 320;
constexpr int height = 200;

/// What both cameras look at, by a camera's exposure.
std::uint8_t level(int x, int y, double exposure) {
  const int checkers = (x / 16 + y / 16) % 2 * 30;
  return static_cast<std::uint8_t>(exposure * (90 + x / 8 + y / 8 + checkers));
}

struct Picture {
  explicit Picture(double exposure) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) pixels.push_back(level(x, y, exposure));
      }
    }
  }
  diminish::Membrane::View view() { return {pixels.data(), width, height, 3 * width, 3}; }
  int at(int x, int y) const { return pixels[static_cast<std::size_t>(3 * (y * width + x))]; }

  std::vector<std::uint8_t> pixels;
};

struct Mask {
  diminish::Membrane::View view() { return {pixels.data(), width, height, width, 1}; }
  void set(int left, int top, int right, int bottom) {
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) pixels[static_cast<std::size_t>(y * width + x)] = 255;
    }
  }

  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(width * height, 0);
};

/// The largest difference from the picture as it should be.
int largest_error(const Picture& picture) {
  int largest = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int error = std::abs(picture.at(x, y) - level(x, y, 1));
      largest = error > largest ? error : largest;
    }
  }
  return largest;
}

}  // namespace

int main() {
  diminish::Membrane membrane;

  Picture picture(1);
  Picture darker(0.7);
  Mask patch;
  patch.set(100, 50, 220, 150);
  membrane.clone({picture.view(), darker.view(), patch.view()}, picture.view());
  std::printf("cloned: at most %d levels off, where the exposures are %d apart\n",
              largest_error(picture), picture.at(0, 0) - darker.at(0, 0));

  Mask hole;
  hole.set(0, 80, 60, 120);
  const bool filled = membrane.fill(hole.view(), picture.view());
  std::printf("filled: %s, the hole's corners are %d and %d\n", filled ? "yes" : "no",
              picture.at(0, 80), picture.at(59, 119));
}
