#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "diminish/error.h"
#include "setup/print/page.h"

namespace diminish {
namespace {

constexpr double wanted_pixels_per_mm = 600 / 25.4;

/// Dots per metre that make a cell a whole number of pixels.
std::uint32_t pixels_per_metre(double cell_mm) {
  const double cell_px = std::max(1.0, std::round(wanted_pixels_per_mm * cell_mm));
  return static_cast<std::uint32_t>(std::lround(1000 * cell_px / cell_mm));
}

/// The checksum of PNG chunks (ISO/IEC 15948, annex D).
std::uint32_t crc32(const std::vector<std::uint8_t>& bytes, std::size_t from) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (std::size_t i = from; i < bytes.size(); ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void append_big_endian(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

/// The chunk with the size of a pixel, which OpenCV does not write.
std::vector<std::uint8_t> physical_size_chunk(std::uint32_t dots_per_metre) {
  std::vector<std::uint8_t> chunk;
  append_big_endian(chunk, 9);
  for (const char c : {'p', 'H', 'Y', 's'}) chunk.push_back(static_cast<std::uint8_t>(c));
  append_big_endian(chunk, dots_per_metre);
  append_big_endian(chunk, dots_per_metre);
  chunk.push_back(1);  // the unit is the metre
  append_big_endian(chunk, crc32(chunk, 4));
  return chunk;
}

void draw_text(cv::Mat& picture, const Page::Text& text, double pixels_per_mm) {
  const int font = cv::FONT_HERSHEY_SIMPLEX;
  const int thickness = std::max(1, static_cast<int>(std::lround(0.25 * pixels_per_mm)));
  // A font's height is the distance between lines; capitals are 0.7 of that.
  const int capital_px = static_cast<int>(std::lround(0.7 * text.height * pixels_per_mm));
  cv::putText(picture, text.text,
              {static_cast<int>(std::lround(text.x * pixels_per_mm)),
               static_cast<int>(std::lround(text.y * pixels_per_mm))},
              font, cv::getFontScaleFromHeight(font, capital_px, thickness), cv::Scalar(0),
              thickness);
}

}  // namespace

std::vector<std::uint8_t> page_as_png(const Page& page) {
  const std::uint32_t dots_per_metre = pixels_per_metre(page.cell_mm);
  const double scale = dots_per_metre / 1000.0;
  const auto to_px = [&](double mm) { return static_cast<int>(std::lround(mm * scale)); };
  cv::Mat picture(to_px(page.height_mm), to_px(page.width_mm), CV_8U, cv::Scalar(255));
  const cv::Rect whole(0, 0, picture.cols, picture.rows);
  for (const Page::Rectangle& r : page.black) {
    const int x = to_px(r.x);
    const int y = to_px(r.y);
    picture(cv::Rect(x, y, to_px(r.x + r.width) - x, to_px(r.y + r.height) - y) & whole) = 0;
  }
  for (const Page::Text& text : page.texts) draw_text(picture, text, scale);
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_BILEVEL, 1})) {
    throw Error(Error::internal, "the sheet cannot be encoded as PNG");
  }
  // After the signature (8 bytes) and the header chunk (25).
  const std::vector<std::uint8_t> chunk = physical_size_chunk(dots_per_metre);
  png.insert(png.begin() + 33, chunk.begin(), chunk.end());
  return png;
}

}  // namespace diminish
