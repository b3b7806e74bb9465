#include "serve/picture_encoder.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

void stack(ImageView<Bgr> top, ImageView<Bgr> bottom, Image<Bgr>& both) {
  both.resize(top.width(), top.height() + bottom.height());
  for (int y = 0; y < both.height(); ++y) {
    const Bgr* row = y < top.height() ? top.row(y) : bottom.row(y - top.height());
    std::copy_n(row, both.width(), both.row(y));
  }
}

ImageView<Bgr> picture(const LiveFrame& frame, View view, Image<Bgr>& scratch) {
  if (view == View::before) return frame.input.color;
  if (view == View::after) return frame.result.picture;
  stack(frame.input.color, frame.result.picture, scratch);
  return scratch;
}

}  // namespace

View parse_view(const std::string& name) {
  const auto found = std::find(view_names.begin(), view_names.end(), name);
  if (found == view_names.end()) {
    throw Error("view: expected one of " + join({view_names.begin(), view_names.end()}) +
                ", got '" + printable(name) + "'");
  }
  return static_cast<View>(found - view_names.begin());
}

PictureEncoder::Bytes PictureEncoder::jpeg(const LiveFrame& frame, View view) {
  Kept& kept = kept_[static_cast<std::size_t>(view)];
  const std::lock_guard lock(kept.mutex);
  if (kept.number == frame.number && kept.bytes) return kept.bytes;
  auto bytes = std::make_shared<std::vector<std::uint8_t>>();
  cv::imencode(".jpg", as_mat(picture(frame, view, kept.stacked)), *bytes,
               {cv::IMWRITE_JPEG_QUALITY, jpeg_quality_});
  kept.number = frame.number;
  kept.bytes = std::move(bytes);
  return kept.bytes;
}

std::vector<std::uint8_t> PictureEncoder::png(const LiveFrame& frame, View view) const {
  Image<Bgr> scratch;
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", as_mat(picture(frame, view, scratch)), bytes,
               {cv::IMWRITE_PNG_COMPRESSION, 1});
  return bytes;
}

}  // namespace diminish
