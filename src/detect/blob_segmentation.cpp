#include "detect/blob_segmentation.h"

#include <algorithm>

#include "detect/extremum_filters.h"
#include "detect/shrink_picture.h"

namespace diminish {

void BlobSegmentation::shrink(const Image<Bgr>& image) {
  // The size of the picture that is divided: enough for blobs of a few pixels, small enough to be
  // quick and to average the noise.
  constexpr int width = 480;
  constexpr int largest_scale = 16;
  scale_ = std::min((image.width() + width - 1) / width, largest_scale);
  shrink_picture(image, scale_, sums_, small_);
}

void BlobSegmentation::segment(const Rect& window) {
  window_ = window;
  smooth_.resize(window.width, window.height);
  for (int y = 0; y < window.height; ++y) {
    smoother_.smooth_row(small_, window, y, 0, window.width, smooth_.row(y));
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
  gradient_.resize(window_.width, window_.height);
  for (std::size_t i = 0; i < gradient_.size(); ++i) {
    const Bgr& light = lightest_.data()[i];
    const Bgr& dark = darkest_.data()[i];
    gradient_.data()[i] =
        static_cast<std::uint8_t>(std::max({light.b - dark.b, light.g - dark.g, light.r - dark.r}));
  }
  // What changes less than this, in 8-bit levels, is even; noise has minima everywhere.
  constexpr std::uint8_t even = 6;
  erode(gradient_, {2, 2}, scratch_, lowest_);
  seeds_.resize(window_.width, window_.height);
  for (std::size_t i = 0; i < seeds_.size(); ++i) {
    seeds_.data()[i] = gradient_.data()[i] <= std::max(lowest_.data()[i], even) ? 255 : 0;
  }
  seed_regions_.find(seeds_, 255, Connectivity::four);
  labels_.resize(window_.width, window_.height, 0);
  for (const ConnectedRegions::Run& run : seed_regions_.runs()) {
    std::fill_n(labels_.row(run.y) + run.first, run.last - run.first,
                static_cast<std::uint32_t>(run.region + 1));
  }
}

void BlobSegmentation::average_colors() {
  color_sums_.assign(seed_regions_.regions().size() + 1, Eigen::Vector4i::Zero());
  for (int y = 0; y < labels_.height(); ++y) {
    std::uint32_t* const label = labels_.row(y);
    const Bgr* const color = small_.row(window_.y + y) + window_.x;
    for (int x = 0; x < labels_.width(); ++x) {
      if (!WatershedLabel<std::uint32_t>::is_basin(label[x])) label[x] = 0;
      color_sums_[label[x]] += Eigen::Vector4i(color[x].b, color[x].g, color[x].r, 1);
    }
  }
  mean_bgr_.resize(color_sums_.size());
  for (std::size_t i = 0; i < mean_bgr_.size(); ++i) {
    mean_bgr_[i] = color_sums_[i].head<3>().cast<double>() / std::max(color_sums_[i][3], 1);
  }
}

}  // namespace diminish
