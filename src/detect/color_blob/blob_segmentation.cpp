#include "detect/color_blob/blob_segmentation.h"

#include <algorithm>

#include "core/extremum_filters.h"
#include "core/shrink.h"

namespace diminish {

int BlobSegmentation::scale(ImageView<Bgr> image) {
  // The size of the picture that is divided: enough for blobs of a few pixels, small enough to be
  // quick and to average the noise.
  constexpr int width = 480;
  constexpr int largest = 16;
  return std::min((image.width() + width - 1) / width, largest);
}

void BlobSegmentation::segment(ImageView<Bgr> image, const Rect& window) {
  shrink(image, scale(image), window, sums_, small_);
  smooth_.resize(window.width, window.height);
  for (int y = 0; y < window.height; ++y) {
    smoother_.smooth_row(small_, small_.bounds(), y, 0, window.width, smooth_.row(y));
  }
  find_seeds();
  watershed_.flood(smooth_, labels_);
  average_colors();
}

/// Each blob grows from a place where the colour changes least: `labels_` becomes the numbers of
/// the gradient magnitude's minima, all of them being one where they touch, and 0 elsewhere.
void BlobSegmentation::find_seeds() {
  dilate(smooth_, {1, 1}, picture_scratch_, lightest_);
  erode(smooth_, {1, 1}, picture_scratch_, darkest_);
  gradient_.resize(small_.width(), small_.height());
  std::transform(lightest_.begin(), lightest_.end(), darkest_.begin(), gradient_.begin(),
                 [](const Bgr& light, const Bgr& dark) {
                   const int blue_green = std::max(light.b - dark.b, light.g - dark.g);
                   return static_cast<std::uint8_t>(std::max(blue_green, light.r - dark.r));
                 });
  // What changes less than this, in 8-bit levels, is even; noise has minima everywhere.
  constexpr std::uint8_t even = 6;
  erode(gradient_, {2, 2}, scratch_, lowest_);
  seeds_.resize(small_.width(), small_.height());
  std::transform(gradient_.begin(), gradient_.end(), lowest_.begin(), seeds_.begin(),
                 [](std::uint8_t own, std::uint8_t lowest) -> std::uint8_t {
                   return own <= even || own <= lowest ? 255 : 0;
                 });
  seed_regions_.find(seeds_, Pixels::set, Connectivity::four);
  labels_.resize(small_.width(), small_.height(), 0);
  for (const ConnectedRegions::Run& run : seed_regions_.runs()) {
    std::fill_n(labels_.row(run.y) + run.first, run.last - run.first,
                static_cast<std::uint32_t>(run.region + 1));
  }
}

void BlobSegmentation::average_colors() {
  color_sums_.assign(seed_regions_.regions().size() + 1, Eigen::Vector4i::Zero());
  for (int y = 0; y < labels_.height(); ++y) {
    std::uint32_t* const label = labels_.row(y);
    const Bgr* const color = small_.row(y);
    for (int x = 0; x < labels_.width();) {
      if (!WatershedLabel<std::uint32_t>::is_basin(label[x])) {
        label[x++] = 0;
        continue;
      }
      const std::uint32_t blob = label[x];
      const int begin = x;
      int blue = 0;
      int green = 0;
      int red = 0;
      for (; x < labels_.width() && label[x] == blob; ++x) {
        blue += color[x].b;
        green += color[x].g;
        red += color[x].r;
      }
      color_sums_[blob] += Eigen::Vector4i(blue, green, red, x - begin);
    }
  }
  mean_bgr_.resize(color_sums_.size());
  for (std::size_t i = 0; i < mean_bgr_.size(); ++i) {
    mean_bgr_[i] = color_sums_[i].head<3>().cast<double>() / std::max(color_sums_[i][3], 1);
  }
}

}  // namespace diminish
