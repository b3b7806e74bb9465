#include <algorithm>
#include <bit>
#include <cmath>

#include "remote/layer_codec.h"
#include "remote/node_fields.h"
#include "remote/node_messages.h"
#include "ros/depth_codec.h"
#include "scene/sample_grid.h"

namespace diminish {
namespace {

using namespace node_fields;
using ros::MessageReader;
using ros::MessageWriter;

constexpr std::size_t most_markers = 256;
/// Brightness travels in sixteenths of a level, and 0 is none.
constexpr float brightness_steps = 16;
/// Of the first plane of points.
constexpr int no_point = 0, no_color = 1, first_color = 2;

/// Values of points in the places of the grid: one above another.
struct PointPlanes {
  static constexpr int colors = 3;
  static constexpr int brightness = 3;
  static constexpr int all = colors + 1 + brightness;  ///< one is depth

  explicit PointPlanes(const SampleGrid& grid_)
      : grid(grid_), values(grid.columns(), all * grid.rows()) {}
  std::uint16_t& operator()(int plane, int column, int row) {
    return values(column, plane * grid.rows() + row);
  }

  SampleGrid grid;
  Image<std::uint16_t> values;
};

/// Brightness as it is: the bits of a number, and one more, so that 0 is none.
struct ExactBrightness {
  explicit ExactBrightness(const SampleGrid& grid_)
      : grid(grid_), words(grid.columns(), PointPlanes::brightness * grid.rows()) {}

  void put(std::size_t plane, int column, int row, float brightness) {
    words(column, place(plane, row)) =
        brightness < 0 ? 0 : 1 + std::bit_cast<std::uint32_t>(brightness);
  }
  float get(std::size_t plane, int column, int row) const {
    const std::uint32_t word = words(column, place(plane, row));
    if (word == 0) return -1;
    const auto brightness = std::bit_cast<float>(word - 1);
    expect(brightness >= 0 && brightness < 256, "expected brightness of 256 levels");
    return brightness;
  }
  int place(std::size_t plane, int row) const {
    return static_cast<int>(plane) * grid.rows() + row;
  }

  SampleGrid grid;
  Image<std::uint32_t> words;
};

void write_points(MessageWriter& writer, const Glance& glance, const SampleGrid& grid, bool exact) {
  PointPlanes planes(grid);
  ExactBrightness words(grid);
  for (const GlancePoint& point : glance.points) {
    const int column = (point.column - grid.column(0)) / grid.step;
    const int row = (point.row - grid.row(0)) / grid.step;
    const auto put = [&](int plane, int value) {
      planes(plane, column, row) = static_cast<std::uint16_t>(value);
    };
    put(0, point.has_color ? first_color + 2 * point.color.g + (point.even ? 1 : 0) : no_color);
    put(1, glance.depth(point.column, point.row));
    if (!point.has_color) continue;
    put(2, 256 + point.color.b - point.color.g);
    put(3, 256 + point.color.r - point.color.g);
    for (std::size_t k = 0; k < point.brightness.size(); ++k) {
      if (exact) words.put(k, column, row, point.brightness[k]);
      if (exact || point.brightness[k] < 0) continue;
      put(4 + static_cast<int>(k),
          1 + static_cast<int>(std::lrint(point.brightness[k] * brightness_steps)));
    }
  }
  writer.bytes(bytes_of([&](auto& bytes) { ros::compress_depth(planes.values, bytes); }));
  if (exact) writer.bytes(bytes_of([&](auto& bytes) { compress_words(words.words, bytes); }));
}

void read_points(MessageReader& reader, const SampleGrid& grid, bool exact, Glance& glance) {
  PointPlanes planes(grid);
  ExactBrightness words(grid);
  const auto bytes = reader.bytes();
  if (!planes.values.empty()) ros::decompress_depth(bytes, planes.values);
  if (exact) decompress_words(reader.bytes(), words.words);
  glance.points.clear();
  glance.point_step_px = grid.step;
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int first = planes(0, j, i);
      if (first == no_point) continue;
      GlancePoint point;
      point.column = static_cast<std::uint16_t>(grid.column(j));
      point.row = static_cast<std::uint16_t>(grid.row(i));
      glance.depth(point.column, point.row) = planes(1, j, i);
      point.has_color = first != no_color;
      if (point.has_color) {
        const auto level = [](int value) {
          return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
        };
        const int green = (first - first_color) / 2;
        point.even = (first - first_color) % 2 != 0;
        point.color = {level(planes(2, j, i) - 256 + green), level(green),
                       level(planes(3, j, i) - 256 + green)};
        for (std::size_t k = 0; k < point.brightness.size(); ++k) {
          const int value = planes(4 + static_cast<int>(k), j, i);
          if (exact) point.brightness[k] = words.get(k, j, i);
          if (!exact && value > 0)
            point.brightness[k] = static_cast<float>(value - 1) / brightness_steps;
        }
      }
      glance.points.push_back(point);
    }
  }
}

/// With the depth around each.
void write_markers(MessageWriter& writer, const Glance& glance) {
  const std::size_t count = std::min(glance.markers.size(), most_markers);
  writer.count(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Marker& marker = glance.markers[i];
    writer.number(static_cast<std::int32_t>(marker.id));
    for (const Eigen::Vector2d& corner : marker.corners) {
      writer.number(corner.x());
      writer.number(corner.y());
    }
  }
  writer.count(glance.depth_parts.size());
  for (const Rect& part : glance.depth_parts) {
    write(writer, part);
    if (part.empty()) continue;
    Image<std::uint16_t> depth(part.width, part.height);
    for (int y = 0; y < part.height; ++y) {
      std::copy_n(glance.depth.row(part.y + y) + part.x, part.width, depth.row(y));
    }
    writer.bytes(bytes_of([&](auto& bytes) { ros::compress_depth(depth, bytes); }));
  }
}

void read_markers(MessageReader& reader, Glance& glance) {
  constexpr std::size_t least_marker = sizeof(std::int32_t) + 8 * sizeof(double);
  glance.markers.resize(reader.count(most_markers, least_marker));
  for (Marker& marker : glance.markers) {
    marker.id = reader.number<std::int32_t>();
    for (Eigen::Vector2d& corner : marker.corners) {
      for (int axis = 0; axis < 2; ++axis) {
        corner[axis] = within(reader, -largest_side_px, 2 * largest_side_px,
                              "expected corners in the picture");
      }
    }
  }
  glance.depth_parts.resize(reader.count(most_markers, 4 * sizeof(std::int32_t)));
  for (Rect& part : glance.depth_parts) {
    part = read_rect(reader, glance.depth.bounds(), "expected a part of the depth image");
    if (part.empty()) continue;
    Image<std::uint16_t> depth(part.width, part.height);
    ros::decompress_depth(reader.bytes(), depth);
    for (int y = 0; y < part.height; ++y) {
      std::copy_n(depth.row(y), part.width, glance.depth.row(part.y + y) + part.x);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> write_answer(const AnswerHead& head, const Glance& glance,
                                       const GlanceQuestion& asked) {
  const Intrinsics& depth = asked.camera.depth;
  std::vector<std::uint8_t> bytes;
  MessageWriter writer = begin_answer(bytes, head);
  writer.number(glance.color_stamp_s);
  writer.number(glance.depth_stamp_s);
  write_markers(writer, glance);
  write_points(writer, glance, {depth.width, depth.height, asked.wishes.samples},
               asked.wishes.exact);
  return bytes;
}

void read(MessageReader& reader, const GlanceQuestion& asked, Glance& glance) {
  const Intrinsics& depth = asked.camera.depth;
  glance.color_stamp_s = finite(reader);
  glance.depth_stamp_s = finite(reader);
  glance.spacings_px = asked.wishes.spacings_px;
  glance.depth.resize(depth.width, depth.height, 0);
  read_markers(reader, glance);
  read_points(reader, {depth.width, depth.height, asked.wishes.samples}, asked.wishes.exact,
              glance);
}

}  // namespace diminish
