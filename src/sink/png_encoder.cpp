#include "sink/png_encoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string_view>

namespace diminish {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

void append_number(Bytes& bytes, std::size_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
}

void append_chunk(Bytes& file, std::string_view type, const Bytes& data) {
  append_number(file, data.size());
  const std::size_t begin = file.size();
  append(file, type);
  file.insert(file.end(), data.begin(), data.end());
  append_number(file, libdeflate_crc32(0, file.data() + begin, file.size() - begin));
}

Bytes header(const cv::Mat& picture, bool has_palette) {
  constexpr std::uint8_t grey = 0;
  constexpr std::uint8_t rgb = 2;
  constexpr std::uint8_t indexed = 3;
  constexpr std::uint8_t rgba = 6;
  const std::uint8_t colors = picture.channels() == 1   ? (has_palette ? indexed : grey)
                              : picture.channels() == 3 ? rgb
                                                        : rgba;
  Bytes data;
  append_number(data, static_cast<std::size_t>(picture.cols));
  append_number(data, static_cast<std::size_t>(picture.rows));
  data.insert(data.end(), {8, colors, 0, 0, 0});  // bits; deflate, the usual filters, all rows
  return data;
}

/// Each row behind the number of its filter. Colours are stored as the difference to the average of
/// the neighbours on the left and above; masks and indices compress best as they are.
Bytes filtered_rows(const cv::Mat& picture) {
  constexpr std::uint8_t unchanged = 0;
  constexpr std::uint8_t average = 3;
  const auto pixel = static_cast<std::size_t>(picture.channels());
  const std::size_t width = pixel * static_cast<std::size_t>(picture.cols);
  Bytes rows((width + 1) * static_cast<std::size_t>(picture.rows));
  const Bytes nothing(width);
  const std::uint8_t* above = nothing.data();
  std::uint8_t* target = rows.data();
  for (int y = 0; y < picture.rows; ++y) {
    const std::uint8_t* const row = picture.ptr(y);
    *target++ = pixel == 1 ? unchanged : average;
    if (pixel == 1) {
      std::copy_n(row, width, target);
    } else {
      for (std::size_t i = 0; i < pixel; ++i) {
        target[i] = static_cast<std::uint8_t>(row[i] - above[i] / 2);
      }
      for (std::size_t i = pixel; i < width; ++i) {
        target[i] = static_cast<std::uint8_t>(row[i] - (row[i - pixel] + above[i]) / 2);
      }
    }
    target += width;
    above = row;
  }
  return rows;
}

Bytes compressed(const Bytes& bytes) {
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(fastest), libdeflate_free_compressor);
  Bytes result(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  result.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(),
                                         result.data(), result.size()));
  return result;
}

}  // namespace

std::vector<std::uint8_t> encode_png(const cv::Mat& picture, const std::vector<Bgr>& palette) {
  cv::Mat ordered;
  if (picture.channels() == 1) ordered = picture;
  if (picture.channels() == 3) cv::cvtColor(picture, ordered, cv::COLOR_BGR2RGB);
  if (picture.channels() == 4) cv::cvtColor(picture, ordered, cv::COLOR_BGRA2RGBA);
  Bytes file;
  append(file, "\x89PNG\r\n\x1a\n");
  append_chunk(file, "IHDR", header(ordered, !palette.empty()));
  if (!palette.empty()) {
    Bytes colors;
    for (const Bgr& color : palette) colors.insert(colors.end(), {color.r, color.g, color.b});
    append_chunk(file, "PLTE", colors);
  }
  append_chunk(file, "IDAT", compressed(filtered_rows(ordered)));
  append_chunk(file, "IEND", {});
  return file;
}

}  // namespace diminish
