#include "remote/node_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "blend/confidence_grid.h"
#include "core/limits.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "diminish/validate.h"
#include "remote/layer_codec.h"
#include "ros/depth_codec.h"
#include "ros/message_writer.h"
#include "ros/pixel_encodings.h"
#include "scene/sample_grid.h"

namespace diminish {
namespace {

using ros::MessageReader;
using ros::MessageWriter;
using ros::Wire;

constexpr std::uint32_t version = 1;
constexpr std::size_t most_markers = 256;
constexpr int most_samples = 100'000;
constexpr double longest_wait_s = 60;
constexpr int most_user_pixels = 10'000'000;
constexpr int largest_side_px = 16384;
/// Brightness travels in sixteenths of a level, and 0 is none.
constexpr float brightness_steps = 16;
/// 1 / z of what is a millimetre away.
constexpr float most_inverse_z = 1000;
constexpr double least_depth_unit_m = 1e-6;
/// Of the first plane of points.
constexpr int no_point = 0, no_color = 1, first_color = 2;

void expect(bool condition, const char* what) {
  if (!condition) throw Error(Error::input, what);
}

double finite(MessageReader& reader) {
  const auto value = reader.number<double>();
  expect(std::isfinite(value), "expected finite numbers");
  return value;
}

double within(MessageReader& reader, double least, double most, const char* what) {
  const double value = finite(reader);
  expect(value >= least && value <= most, what);
  return value;
}

/// A count or a size.
int integer(MessageReader& reader, int least, int most, const char* what) {
  const auto value = reader.number<std::int32_t>();
  expect(value >= least && value <= most, what);
  return value;
}

/// Bit for bit, where a quaternion would round.
void write(MessageWriter& writer, const RigidTransform& transform) {
  for (int i = 0; i < 9; ++i) writer.number(transform.rotation(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) writer.number(transform.translation[i]);
}

RigidTransform read_transform(MessageReader& reader) {
  RigidTransform transform;
  for (int i = 0; i < 9; ++i) transform.rotation(i / 3, i % 3) = finite(reader);
  for (int i = 0; i < 3; ++i) {
    transform.translation[i] = within(reader, -largest_coordinate_m, largest_coordinate_m,
                                      "expected a translation of at most 1000 m");
  }
  const Eigen::Matrix3d& r = transform.rotation;
  constexpr double rounding = 1e-3;
  expect((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < rounding &&
             r.determinant() > 0,
         "expected a rotation");
  return transform;
}

void write(MessageWriter& writer, const Intrinsics& lens) {
  writer.number(static_cast<std::uint32_t>(lens.width));
  writer.number(static_cast<std::uint32_t>(lens.height));
  writer.doubles<4>({lens.fx, lens.fy, lens.cx, lens.cy});
  writer.doubles(lens.distortion);
  writer.number(static_cast<std::uint8_t>(lens.lens_model));
}

Intrinsics read_lens(MessageReader& reader) {
  Intrinsics lens;
  const auto width = reader.number<std::uint32_t>();
  const auto height = reader.number<std::uint32_t>();
  ros::expect_camera_size(width, height);
  lens.width = static_cast<int>(width);
  lens.height = static_cast<int>(height);
  for (double* value : {&lens.fx, &lens.fy, &lens.cx, &lens.cy}) *value = finite(reader);
  for (double& value : lens.distortion) value = finite(reader);
  const auto model = reader.number<std::uint8_t>();
  expect(model <= static_cast<std::uint8_t>(LensModel::fisheye), "expected a known lens model");
  lens.lens_model = static_cast<LensModel>(model);
  return lens;
}

void write(MessageWriter& writer, const NodeHead& head) {
  writer.number(version);
  writer.number(static_cast<std::uint8_t>(head.topic));
  writer.number(head.user);
  writer.number(head.frame);
}

void read_head(MessageReader& reader, NodeHead& head) {
  const auto found = reader.number<std::uint32_t>();
  if (found != version) {
    throw Error(Error::input,
                "expected the messages of this version of diminish: the node's and "
                "the user's differ");
  }
  const auto topic = reader.number<std::uint8_t>();
  expect(topic <= static_cast<std::uint8_t>(NodeTopic::layer), "expected a glance or a layer");
  head.topic = static_cast<NodeTopic>(topic);
  head.user = reader.number<std::uint64_t>();
  head.frame = reader.number<std::uint64_t>();
}

/// To be sent at once.
MessageWriter begin_answer(std::vector<std::uint8_t>& bytes, const AnswerHead& head) {
  MessageWriter writer(bytes, Wire::cdr);
  write(writer, static_cast<const NodeHead&>(head));
  writer.number(head.asked_s);
  writer.number(head.received_s);
  writer.number(monotonic_now_s());
  writer.text(head.problem);
  return writer;
}

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
    if constexpr (std::is_same_v<Value, bool>) value = reader.number<std::uint8_t>() != 0;
    if constexpr (std::is_same_v<Value, double>) {
      value = within(reader, info.min, info.max, "expected options within their range");
    }
  });
}

void write(MessageWriter& writer, const TiledRegion& region) {
  for (const int value : {region.x, region.y, region.width, region.height}) writer.number(value);
  std::vector<std::uint8_t> kept;
  for (std::size_t i = 0; i < region.kept_tiles().size(); ++i) {
    if (i % 8 == 0) kept.push_back(0);
    if (region.kept_tiles()[i] != 0) kept.back() |= static_cast<std::uint8_t>(1U << i % 8);
  }
  writer.bytes(kept);
}

void read(MessageReader& reader, const Rect& picture, TiledRegion& region) {
  Rect box;
  for (int* value : {&box.x, &box.y, &box.width, &box.height}) {
    *value = integer(reader, 0, largest_side_px, "expected a region of the picture");
  }
  expect(!box.empty() && intersect(box, picture) == box, "expected a region of the picture");
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

/// What `write` appends.
template <class Write>
std::vector<std::uint8_t> bytes_of(const Write& write) {
  std::vector<std::uint8_t> bytes;
  write(bytes);
  return bytes;
}

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

Rect read_rect(MessageReader& reader, const Rect& within) {
  Rect rect;
  for (int* value : {&rect.x, &rect.y, &rect.width, &rect.height}) {
    *value = integer(reader, 0, largest_side_px, "expected a part of the depth image");
  }
  expect(rect.empty() || intersect(rect, within) == rect, "expected a part of the depth image");
  return rect;
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
    for (const int value : {part.x, part.y, part.width, part.height}) writer.number(value);
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
    part = read_rect(reader, glance.depth.bounds());
    if (part.empty()) continue;
    Image<std::uint16_t> depth(part.width, part.height);
    ros::decompress_depth(reader.bytes(), depth);
    for (int y = 0; y < part.height; ++y) {
      std::copy_n(depth.row(y), part.width, glance.depth.row(part.y + y) + part.x);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> write_question(const NodeHead& head, const GlanceQuestion& question) {
  std::vector<std::uint8_t> bytes;
  MessageWriter writer(bytes, Wire::cdr);
  write(writer, head);
  writer.doubles<4>(
      {question.asked_s, question.stamp_s, question.tolerance_s, question.patience_s});
  write(writer, question.camera.color);
  write(writer, question.camera.depth);
  writer.number(question.camera.depth_unit_m);
  write(writer, question.camera.color_from_depth);
  write(writer, question.user);
  writer.text(question.wishes.marker_dictionary);
  for (const int spacing : question.wishes.spacings_px) writer.number(spacing);
  writer.number(question.wishes.samples);
  writer.number(std::uint8_t{question.wishes.exact});
  return bytes;
}

void read(MessageReader& reader, GlanceQuestion& question) {
  question.asked_s = finite(reader);
  question.stamp_s = finite(reader);
  question.tolerance_s = within(reader, 0, longest_wait_s, "expected a tolerance up to a minute");
  question.patience_s = within(reader, 0, longest_wait_s, "expected patience up to a minute");
  question.camera.name = "camera";
  question.camera.color = read_lens(reader);
  question.camera.depth = read_lens(reader);
  question.camera.depth_unit_m = finite(reader);
  question.camera.color_from_depth = read_transform(reader);
  question.user = read_lens(reader);
  expect(question.user.width * question.user.height <= most_user_pixels,
         "expected a user's picture of at most 10 million pixels");
  question.wishes.marker_dictionary = reader.text();
  for (int& spacing : question.wishes.spacings_px) {
    spacing = integer(reader, 0, largest_side_px, "expected a spacing of pixels");
  }
  question.wishes.samples = integer(reader, 1, most_samples, "expected at most 100000 samples");
  question.wishes.exact = reader.number<std::uint8_t>() != 0;
  Rig rig;
  rig.color = question.user;
  rig.rgbd.push_back(question.camera);
  validate(rig);
}

std::vector<std::uint8_t> write_question(const NodeHead& head, const RemoteDrawing& drawing,
                                         int jpeg_quality, double depth_unit_m) {
  std::vector<std::uint8_t> bytes;
  MessageWriter writer(bytes, Wire::cdr);
  write(writer, head);
  write(writer, drawing.color_from_depth);
  writer.bytes(bytes_of([&](auto& to) { compress_mask(drawing.rgbd_color, to); }));
  writer.bytes(bytes_of([&](auto& to) { compress_mask(drawing.rgbd_depth, to); }));
  write(writer, drawing.region);
  write_options(writer, drawing.options);
  writer.number(jpeg_quality);
  writer.number(depth_unit_m);
  return bytes;
}

void read(MessageReader& reader, const GlanceQuestion& asked, LayerQuestion& question) {
  question.color_from_depth = read_transform(reader);
  question.rgbd_color.resize(asked.camera.color.width, asked.camera.color.height);
  decompress_mask(reader.bytes(), question.rgbd_color);
  question.rgbd_depth.resize(asked.camera.depth.width, asked.camera.depth.height);
  decompress_mask(reader.bytes(), question.rgbd_depth);
  read(reader, asked.user.bounds(), question.region);
  read_options(reader, question.options);
  question.jpeg_quality = integer(reader, 0, 100, "expected a quality up to 100");
  question.depth_unit_m = within(reader, 0, 1, "expected a step of depth up to a metre");
}

NodeMessage<NodeHead> open_question(std::span<const std::uint8_t> bytes) {
  NodeMessage<NodeHead> message{{}, MessageReader(bytes, Wire::cdr)};
  read_head(message.rest, message.head);
  return message;
}

NodeMessage<AnswerHead> open_answer(std::span<const std::uint8_t> bytes) {
  NodeMessage<AnswerHead> message{{}, MessageReader(bytes, Wire::cdr)};
  read_head(message.rest, message.head);
  message.head.asked_s = finite(message.rest);
  message.head.received_s = finite(message.rest);
  message.head.sent_s = finite(message.rest);
  message.head.problem = message.rest.text();
  return message;
}

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

std::vector<std::uint8_t> write_answer(const AnswerHead& head, RemoteLayer& layer, int jpeg_quality,
                                       double depth_unit_m) {
  const bool is_jpeg = jpeg_quality > 0;
  const bool is_exact = depth_unit_m == 0;
  const auto color = bytes_of([&](auto& to) {
    if (is_jpeg) return compress_jpeg(layer.color, layer.inverse_z, jpeg_quality, to);
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
  std::vector<std::uint8_t> bytes;
  bytes.reserve(color.size() + depth.size() + resolution.size() + 512);
  MessageWriter writer = begin_answer(bytes, head);
  writer.number(depth_unit_m);
  writer.bytes(depth);
  writer.number(std::uint8_t{is_jpeg});
  writer.bytes(color);
  writer.bytes(resolution);
  return bytes;
}

void read(MessageReader& reader, RemoteLayer& layer) {
  const Rect& region = layer.region;
  const double depth_unit_m = within(reader, 0, 1, "expected a step of depth up to a metre");
  const bool is_exact = depth_unit_m == 0;
  layer.inverse_z.resize(region.width, region.height);
  if (is_exact) {
    decompress_exactly(reader.bytes(), most_inverse_z, layer.inverse_z);
  } else {
    decompress_inverse_z(reader.bytes(), std::max(depth_unit_m, least_depth_unit_m),
                         layer.inverse_z);
  }
  layer.color.resize(region.width, region.height);
  const bool is_jpeg = reader.number<std::uint8_t>() != 0;
  if (is_jpeg) {
    decompress_jpeg(reader.bytes(), layer.color);
  } else {
    decompress_color(reader.bytes(), layer.inverse_z, layer.color);
  }
  ConfidenceGrid grid;
  grid.begin(region, {}, 0);
  layer.resolution.resize(grid.columns(), grid.rows());
  if (is_exact) {
    decompress_exactly(reader.bytes(), std::numeric_limits<float>::max(), layer.resolution);
  } else {
    decompress_resolution(reader.bytes(), layer.resolution);
  }
}

std::vector<std::uint8_t> write_answer(const AnswerHead& head) {
  std::vector<std::uint8_t> bytes;
  begin_answer(bytes, head);
  return bytes;
}

}  // namespace diminish
