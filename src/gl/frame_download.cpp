#include "gl/frame_download.h"

#include <cstring>

#include "core/rows.h"

namespace diminish::gl {
namespace {

/// Where the parts begin; the picture comes first.
struct Layout {
  std::size_t counts, result, surface, second, end;

  explicit Layout(const Rect& region) {
    const std::size_t pixels = pixels_of(region);
    counts = pixels * sizeof(std::uint32_t);
    result = (counts + sizeof(FrameDownload::Counts) + 15) / 16 * 16;
    surface = result + pixels * sizeof(ResultPixel);
    second = surface + pixels * sizeof(std::uint32_t);
    end = second + pixels * sizeof(SecondPixel);
  }
};

}  // namespace

void FrameDownload::reserve(const Rect& whole, bool blends) {
  const Layout at(whole);
  downloaded_.reserve(blends ? at.end : at.second);
}

void FrameDownload::begin(const Source& source, const Rect& region, const Wanted& wanted,
                          const FrameUpload& upload) {
  region_ = region;
  wanted_ = wanted;
  const std::size_t pixels = pixels_of(region);
  const Layout at(region);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  if (wanted.picture) {
    copy(source.picture.name(), downloaded_.name(), pixels * sizeof(std::uint32_t));
  }
  copy(source.counts.name(), downloaded_.name(), sizeof(Counts), at.counts);
  if (wanted.reconstruction) {
    const ResultBuffers& reconstruction = source.reconstruction;
    copy(reconstruction.first.name(), downloaded_.name(), pixels * sizeof(ResultPixel), at.result);
    if (upload.blends()) {
      copy(reconstruction.second.name(), downloaded_.name(), pixels * sizeof(SecondPixel),
           at.second);
    }
    copy(source.surface.name(), downloaded_.name(), pixels * sizeof(std::uint32_t), at.surface);
  }
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
}

void FrameDownload::read(const FrameInputs& inputs, const FrameUpload& upload,
                         DiminishedFrame& result) const {
  const Layout at(region_);
  const std::byte* const from = downloaded_.data();
  Counts counts{};
  std::memcpy(&counts, from + at.counts, sizeof(counts));
  result.report.mask_pixels = counts.mask;
  result.report.missing_pixels = counts.missing;
  result.report.valid_pixels = counts.mask - counts.missing;
  if (wanted_.picture) read_picture(result);
  if (wanted_.reconstruction) {
    unpack(reinterpret_cast<const ResultPixel*>(from + at.result),
           reinterpret_cast<const SecondPixel*>(from + at.second), upload, result.reconstruction);
  }
  read_surfaces(inputs, result.surfaces);
}

void FrameDownload::read_picture(DiminishedFrame& result) const {
  const auto* const words = reinterpret_cast<const std::uint32_t*>(downloaded_.data());
  for_rows(region_.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint32_t* row = words + static_cast<std::ptrdiff_t>(y) * region_.width;
      Bgr* colors = result.picture.row(region_.y + y) + region_.x;
      std::uint8_t* origin = result.provenance.row(region_.y + y) + region_.x;
      for (int x = 0; x < region_.width; ++x) {
        colors[x] = {static_cast<std::uint8_t>(row[x]), static_cast<std::uint8_t>(row[x] >> 8),
                     static_cast<std::uint8_t>(row[x] >> 16)};
        origin[x] = static_cast<std::uint8_t>(row[x] >> 24);
      }
    }
  });
}

void FrameDownload::read_surfaces(const FrameInputs& inputs, Surfaces& surfaces) const {
  const Rect size = wanted_.reconstruction ? inputs.frame.color.bounds() : Rect{};
  const Rect planes = inputs.planes ? size : Rect{};
  const Rect shaded = inputs.shadows.empty() ? Rect{} : size;
  surfaces.label.resize(planes.width, planes.height);
  surfaces.light.resize(shaded.width, shaded.height);
  if (planes.empty()) return;
  const auto* word =
      reinterpret_cast<const std::uint32_t*>(downloaded_.data() + Layout(region_).surface);
  for (int y = region_.y; y < region_.bottom(); ++y) {
    for (int x = region_.x; x < region_.right(); ++x, ++word) {
      surfaces.label(x, y) = static_cast<std::uint8_t>(*word);
      if (shaded.empty()) continue;
      surfaces.light(x, y) = {static_cast<std::uint8_t>(*word >> 8),
                              static_cast<std::uint8_t>(*word >> 16),
                              static_cast<std::uint8_t>(*word >> 24)};
    }
  }
}

}  // namespace diminish::gl
