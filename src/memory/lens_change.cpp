#include "memory/lens_change.h"

#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "core/rows.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {
LensChange::LensChange(const Intrinsics& from, const Intrinsics& to)
    : width_(to.width), height_(to.height) {
  const std::shared_ptr<const RayTable> rays = RayTable::of(to);
  const Projection lens{Lens(from)};
  cv::Mat_<cv::Vec2f> places(to.height, to.width);
  for_rows(to.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < to.width; ++x) {
        constexpr float nowhere = -2;
        cv::Vec2f& place = places(y, x);
        const Eigen::Vector2f ray = (*rays)(x, y);
        if (!lens.distort(ray.x(), ray.y(), place[0], place[1])) place = {nowhere, nowhere};
      }
    }
  });
  cv::convertMaps(places, cv::noArray(), pixels_, parts_, CV_16SC2);
}

void LensChange::show(ImageView<Bgr> picture, Image<Bgr>& shown) const {
  shown.resize(width_, height_);
  look_up(as_mat(picture), cv::Scalar::all(0), as_mat(shown));
}

void LensChange::hide(const Mask& objects, Mask& hidden) const {
  hidden.resize(width_, height_);
  look_up(as_mat(objects), cv::Scalar::all(255), as_mat(hidden));
}

void LensChange::look_up(const cv::Mat& picture, const cv::Scalar& beyond,
                         const cv::Mat& shown) const {
  for_rows(height_, [&](Rows rows) {
    const cv::Range range(rows.first, rows.last);
    cv::Mat part = shown.rowRange(range);
    cv::remap(picture, part, pixels_.rowRange(range), parts_.rowRange(range), cv::INTER_LINEAR,
              cv::BORDER_CONSTANT, beyond);
  });
}

}  // namespace diminish
