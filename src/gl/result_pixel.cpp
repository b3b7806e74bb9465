#include "gl/result_pixel.h"

#include <array>

#include "reconstruct/clear_outside.h"

namespace diminish::gl {

void unpack(const ResultPixel* pixel, const SecondPixel* second, const FrameUpload& upload,
            Reconstruction& reconstruction) {
  std::array<std::uint8_t, 256> sources{};
  for (int k = 0; k < upload.cameras(); ++k) {
    sources[static_cast<std::size_t>(k + 1)] = static_cast<std::uint8_t>(upload.camera(k).source);
  }
  const Rect& region = reconstruction.region;
  for (int y = region.y; y < region.bottom(); ++y) {
    Bgra* const color = reconstruction.color.row(y) + region.x;
    float* const depth_m = reconstruction.depth_m.row(y) + region.x;
    std::uint8_t* const source = reconstruction.source.row(y) + region.x;
    for (int x = 0; x < region.width; ++x, ++pixel) {
      const auto alpha = static_cast<std::uint8_t>(pixel->place != 0 ? 255 : 0);
      color[x] = {pixel->b, pixel->g, pixel->r, alpha};
      depth_m[x] = pixel->depth_m;
      source[x] = sources[pixel->place];
    }
  }
  SecondView& view = reconstruction.second;
  bool any = false;
  for (int y = region.y; upload.blends() && y < region.bottom(); ++y) {
    Bgra* const color = view.color.row(y) + region.x;
    std::uint8_t* const source = view.source.row(y) + region.x;
    std::uint8_t* const share = view.share.row(y) + region.x;
    for (int x = 0; x < region.width; ++x, ++second) {
      const auto alpha = static_cast<std::uint8_t>(second->place != 0 ? 255 : 0);
      color[x] = {second->b, second->g, second->r, alpha};
      source[x] = sources[second->place];
      share[x] = static_cast<std::uint8_t>(second->share);
      any = any || second->share != 0;
    }
  }
  if (!any) resize_second(false, {}, view);
}

}  // namespace diminish::gl
