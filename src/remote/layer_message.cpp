#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

#include "blend/confidence_grid.h"
#include "remote/layer_codec.h"
#include "remote/node_fields.h"
#include "remote/node_messages.h"

namespace diminish {
namespace {

using namespace node_fields;
using ros::MessageReader;
using ros::MessageWriter;

/// 1 / z of what is a millimetre away.
constexpr float most_inverse_z = 1000;
constexpr float most_resolution = std::numeric_limits<float>::max();
constexpr double least_depth_unit_m = 1e-6;
/// 21 MB. A message has at most 32.
constexpr std::size_t most_raw_pixels = 3'000'000;

/// The switches and numbers that the drawing reads.
template <class AnyOptions, class Visit>
void for_each_drawing_option(AnyOptions& options, Visit&& visit) {
  for_each_option(options, [&](const OptionInfo& info, auto& value) {
    for (const std::string_view name :
         {"remove_flying", "remove_hidden", "smooth_depth", "snap_edges",
          "discontinuity_threshold_m", "discontinuity_reach_m"}) {
      if (info.name == name) visit(info, value);
    }
  });
}

void write_options(MessageWriter& writer, const Options& options) {
  for_each_drawing_option(options, [&](const OptionInfo&, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, bool>) writer.number(std::uint8_t{value});
    if constexpr (std::is_same_v<Value, double>) writer.number(value);
  });
}

void read_options(MessageReader& reader, Options& options) {
  for_each_drawing_option(options, [&](const OptionInfo& info, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, bool>) value = flag(reader);
    if constexpr (std::is_same_v<Value, double>) {
      value = within(reader, info.min, info.max, "expected options within their range");
    }
  });
}

void write_region(MessageWriter& writer, const TiledRegion& region) {
  write(writer, static_cast<const Rect&>(region));
  std::vector<std::uint8_t> kept;
  for (std::size_t i = 0; i < region.kept_tiles().size(); ++i) {
    if (i % 8 == 0) kept.push_back(0);
    if (region.kept_tiles()[i] != 0) kept.back() |= static_cast<std::uint8_t>(1U << i % 8);
  }
  writer.bytes(kept);
}

void read_region(MessageReader& reader, const Rect& picture, TiledRegion& region) {
  constexpr const char* expected = "expected a region of the picture";
  const Rect box = read_rect(reader, picture, expected);
  expect(!box.empty(), expected);
  region.set(box);
  const auto kept = reader.bytes();
  if (kept.empty()) return;
  constexpr int tile = TiledRegion::tile;
  const int left = box.x / tile;
  const int top = box.y / tile;
  const int columns = (box.right() - 1) / tile - left + 1;
  const int rows = (box.bottom() - 1) / tile - top + 1;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  expect(kept.size() == (tiles + 7) / 8, "expected a bit for each of the region's tiles");
  region.keep_if([&](const Rect& pixels) {
    const auto i =
        static_cast<std::size_t>((pixels.y / tile - top) * columns + pixels.x / tile - left);
    return (kept[i / 8] >> i % 8 & 1) != 0;
  });
}

/// As they are in memory: both ends are one machine.
template <class Pixel>
std::span<const std::uint8_t> bytes_in_memory(const Image<Pixel>& image) {
  return {reinterpret_cast<const std::uint8_t*>(image.data()), image.size() * sizeof(Pixel)};
}

/// image: has its size already.
template <class Pixel>
void read_raw_image(MessageReader& reader, Image<Pixel>& image) {
  const auto bytes = reader.bytes();
  const std::size_t size = image.size() * sizeof(Pixel);
  expect(bytes.size() == size, "expected the pixels of the region that was asked for");
  if (size > 0) std::memcpy(image.data(), bytes.data(), size);
}

void write_raw(const AnswerHead& head, const RemoteLayer& layer,
               std::vector<std::uint8_t>& answer) {
  MessageWriter writer = begin_answer(answer, head);
  writer.number(std::uint8_t{true});
  writer.bytes(bytes_in_memory(layer.inverse_z));
  writer.bytes(bytes_in_memory(layer.color));
  writer.bytes(bytes_in_memory(layer.resolution));
}

void read_raw(MessageReader& reader, RemoteLayer& layer) {
  read_raw_image(reader, layer.inverse_z);
  expect_numbers(layer.inverse_z, most_inverse_z);
  read_raw_image(reader, layer.color);
  read_raw_image(reader, layer.resolution);
  expect_numbers(layer.resolution, most_resolution);
}

}  // namespace

std::vector<std::uint8_t> write_question(const NodeHead& head, const RemoteDrawing& drawing,
                                         const LayerCoding& coding) {
  std::vector<std::uint8_t> bytes;
  MessageWriter writer(bytes, ros::Wire::cdr);
  write(writer, head);
  write(writer, drawing.color_from_depth);
  writer.bytes(bytes_of([&](auto& to) { compress_mask(drawing.rgbd_color, to); }));
  writer.bytes(bytes_of([&](auto& to) { compress_mask(drawing.rgbd_depth, to); }));
  write_region(writer, drawing.region);
  write_options(writer, drawing.options);
  writer.number(std::uint8_t{coding.raw});
  writer.number(coding.jpeg_quality);
  writer.number(coding.depth_unit_m);
  return bytes;
}

void read(MessageReader& reader, const GlanceQuestion& asked, LayerQuestion& question) {
  question.color_from_depth = read_transform(reader);
  question.rgbd_color.resize(asked.camera.color.width, asked.camera.color.height);
  decompress_mask(reader.bytes(), question.rgbd_color);
  question.rgbd_depth.resize(asked.camera.depth.width, asked.camera.depth.height);
  decompress_mask(reader.bytes(), question.rgbd_depth);
  read_region(reader, asked.user.bounds(), question.region);
  read_options(reader, question.options);
  question.coding.raw = flag(reader);
  question.coding.jpeg_quality = integer(reader, 0, 100, "expected a quality up to 100");
  question.coding.depth_unit_m = within(reader, 0, 1, "expected a step of depth up to a metre");
}

void write_answer(const AnswerHead& head, RemoteLayer& layer, const LayerCoding& coding,
                  std::vector<std::uint8_t>& answer) {
  const std::size_t pixels = layer.inverse_z.size();
  if (coding.raw && pixels <= most_raw_pixels) return write_raw(head, layer, answer);
  const bool is_jpeg = coding.jpeg_quality > 0;
  const bool is_exact = coding.depth_unit_m == 0;
  double depth_unit_m = coding.depth_unit_m;
  const auto color = bytes_of([&](auto& to) {
    if (is_jpeg) return compress_jpeg(layer.color, layer.inverse_z, coding.jpeg_quality, to);
    compress_color(layer.color, layer.inverse_z, to);
  });
  const auto depth = bytes_of([&](auto& to) {
    if (is_exact) return compress_exactly(layer.inverse_z, to);
    depth_unit_m = compress_inverse_z(layer.inverse_z, depth_unit_m, to);
  });
  const auto resolution = bytes_of([&](auto& to) {
    if (is_exact) return compress_exactly(layer.resolution, to);
    compress_resolution(layer.resolution, to);
  });
  MessageWriter writer = begin_answer(answer, head);
  writer.number(std::uint8_t{false});
  writer.number(depth_unit_m);
  writer.bytes(depth);
  writer.number(std::uint8_t{is_jpeg});
  writer.bytes(color);
  writer.bytes(resolution);
}

void read(MessageReader& reader, RemoteLayer& layer) {
  const Rect& region = layer.region;
  layer.inverse_z.resize(region.width, region.height);
  layer.color.resize(region.width, region.height);
  ConfidenceGrid grid;
  grid.begin(region, {}, 0);
  layer.resolution.resize(grid.columns(), grid.rows());
  const bool is_raw = flag(reader);
  if (is_raw) return read_raw(reader, layer);
  const double depth_unit_m = within(reader, 0, 1, "expected a step of depth up to a metre");
  const bool is_exact = depth_unit_m == 0;
  if (is_exact) {
    decompress_exactly(reader.bytes(), most_inverse_z, layer.inverse_z);
  } else {
    decompress_inverse_z(reader.bytes(), std::max(depth_unit_m, least_depth_unit_m),
                         layer.inverse_z);
  }
  const bool is_jpeg = flag(reader);
  if (is_jpeg) {
    decompress_jpeg(reader.bytes(), layer.color);
  } else {
    decompress_color(reader.bytes(), layer.inverse_z, layer.color);
  }
  if (is_exact) {
    decompress_exactly(reader.bytes(), most_resolution, layer.resolution);
  } else {
    decompress_resolution(reader.bytes(), layer.resolution);
  }
}

}  // namespace diminish
