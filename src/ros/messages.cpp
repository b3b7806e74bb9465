#include "ros/messages.h"

#include <cmath>

#include "core/limits.h"
#include "diminish/error.h"

namespace diminish::ros {
namespace {

constexpr std::size_t most_coefficients = 16;
constexpr std::size_t most_transforms = 1000;
constexpr std::size_t most_statuses = 1000;
constexpr std::size_t most_text = 4096;
/// What a text or a header takes at least, in either format.
constexpr std::size_t least_text = 4;
constexpr std::size_t least_transform = 8 + 2 * least_text + 7 * sizeof(double);

void expect(bool condition, const char* what) {
  if (!condition) throw Error(Error::input, what);
}

Header read_header(MessageReader& reader) {
  Header header;
  if (reader.wire() == Wire::ros1) reader.number<std::uint32_t>();  // its sequence number
  const auto seconds = reader.number<std::int32_t>();
  const auto nanoseconds = reader.number<std::uint32_t>();
  expect(nanoseconds < 1'000'000'000, "expected a stamp with less than 1e9 nanoseconds");
  header.stamp_s = seconds + nanoseconds * 1e-9;
  header.frame_id = reader.text();
  return header;
}

void write_header(MessageWriter& writer, const Header& header) {
  if (writer.wire() == Wire::ros1) writer.number(std::uint32_t{0});
  double seconds = std::floor(header.stamp_s);
  double nanoseconds = std::round((header.stamp_s - seconds) * 1e9);
  if (nanoseconds >= 1e9) {
    seconds += 1;
    nanoseconds = 0;
  }
  writer.number(static_cast<std::int32_t>(seconds));
  writer.number(static_cast<std::uint32_t>(nanoseconds));
  writer.text(header.frame_id);
}

template <std::size_t count>
std::array<double, count> finite(MessageReader& reader) {
  const auto values = reader.doubles<count>();
  for (const double value : values) expect(std::isfinite(value), "expected finite numbers");
  return values;
}

RigidTransform read_transform(MessageReader& reader) {
  const auto t = finite<3>(reader);
  const auto q = finite<4>(reader);
  for (const double value : t) {
    expect(std::abs(value) <= largest_coordinate_m, "expected a translation of at most 1000 m");
  }
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  expect(std::abs(rotation.squaredNorm() - 1) < 0.01, "expected a quaternion of length 1");
  return {rotation.normalized().toRotationMatrix(), {t[0], t[1], t[2]}};
}

void write_transform(MessageWriter& writer, const RigidTransform& transform) {
  const Eigen::Quaterniond q(transform.rotation);
  const Eigen::Vector3d& t = transform.translation;
  writer.doubles<7>({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

}  // namespace

void read(MessageReader& reader, ImageMessage& message) {
  message.header = read_header(reader);
  message.height = reader.number<std::uint32_t>();
  message.width = reader.number<std::uint32_t>();
  message.encoding = reader.text();
  message.is_big_endian = reader.number<std::uint8_t>() != 0;
  message.step = reader.number<std::uint32_t>();
  message.data = reader.bytes();
}

void write(MessageWriter& writer, const ImageMessage& message) {
  write_header(writer, message.header);
  writer.number(message.height);
  writer.number(message.width);
  writer.text(message.encoding);
  writer.number(std::uint8_t{message.is_big_endian});
  writer.number(message.step);
  writer.bytes(message.data);
}

void read(MessageReader& reader, CompressedImageMessage& message) {
  message.header = read_header(reader);
  message.format = reader.text();
  message.data = reader.bytes();
}

void write(MessageWriter& writer, const CompressedImageMessage& message) {
  write_header(writer, message.header);
  writer.text(message.format);
  writer.bytes(message.data);
}

void read(MessageReader& reader, CameraInfoMessage& message) {
  message.header = read_header(reader);
  message.height = reader.number<std::uint32_t>();
  message.width = reader.number<std::uint32_t>();
  message.distortion_model = reader.text();
  message.d.resize(reader.count(most_coefficients, sizeof(double)));
  for (double& value : message.d) value = finite<1>(reader)[0];
  message.k = finite<9>(reader);
  message.r = finite<9>(reader);
  message.p = finite<12>(reader);
  message.binning_x = reader.number<std::uint32_t>();
  message.binning_y = reader.number<std::uint32_t>();
  message.roi_x = reader.number<std::uint32_t>();
  message.roi_y = reader.number<std::uint32_t>();
  message.roi_height = reader.number<std::uint32_t>();
  message.roi_width = reader.number<std::uint32_t>();
  message.roi_is_rectified = reader.number<std::uint8_t>() != 0;
}

void write(MessageWriter& writer, const CameraInfoMessage& message) {
  write_header(writer, message.header);
  writer.number(message.height);
  writer.number(message.width);
  writer.text(message.distortion_model);
  writer.count(message.d.size());
  for (const double value : message.d) writer.number(value);
  writer.doubles(message.k);
  writer.doubles(message.r);
  writer.doubles(message.p);
  for (const std::uint32_t value : {message.binning_x, message.binning_y, message.roi_x,
                                    message.roi_y, message.roi_height, message.roi_width}) {
    writer.number(value);
  }
  writer.number(std::uint8_t{message.roi_is_rectified});
}

void read(MessageReader& reader, TfMessage& message) {
  message.transforms.resize(reader.count(most_transforms, least_transform));
  for (TransformStamped& transform : message.transforms) {
    transform.header = read_header(reader);
    transform.child = reader.text();
    transform.parent_from_child = read_transform(reader);
  }
}

void write(MessageWriter& writer, const TfMessage& message) {
  writer.count(message.transforms.size());
  for (const TransformStamped& transform : message.transforms) {
    write_header(writer, transform.header);
    writer.text(transform.child);
    write_transform(writer, transform.parent_from_child);
  }
}

void read(MessageReader& reader, DiagnosticArray& message) {
  message.header = read_header(reader);
  message.statuses.resize(reader.count(most_statuses, 1 + 4 * least_text));
  for (DiagnosticStatus& status : message.statuses) {
    const auto level = reader.number<std::uint8_t>();
    expect(level <= DiagnosticStatus::stale, "expected a diagnostic level from 0 to 3");
    status.level = static_cast<DiagnosticStatus::Level>(level);
    status.name = reader.text(most_text);
    status.message = reader.text(most_text);
    status.hardware_id = reader.text(most_text);
    status.values.resize(reader.count(most_statuses, 2 * least_text));
    for (auto& [key, value] : status.values) {
      key = reader.text(most_text);
      value = reader.text(most_text);
    }
  }
}

void write(MessageWriter& writer, const DiagnosticArray& message) {
  write_header(writer, message.header);
  writer.count(message.statuses.size());
  for (const DiagnosticStatus& status : message.statuses) {
    writer.number(std::uint8_t{status.level});
    writer.text(status.name);
    writer.text(status.message);
    writer.text(status.hardware_id);
    writer.count(status.values.size());
    for (const auto& [key, value] : status.values) {
      writer.text(key);
      writer.text(value);
    }
  }
}

void read(MessageReader& reader, RgbdMessage& message) {
  read(reader, message.color);
  read(reader, message.depth);
  read(reader, message.color_info);
  read(reader, message.depth_info);
  message.depth_unit_m = finite<1>(reader)[0];
  expect(message.depth_unit_m > 0 && message.depth_unit_m <= 1,
         "expected a depth unit above 0 and at most 1 m");
  message.color_from_depth = read_transform(reader);
}

void write(MessageWriter& writer, const RgbdMessage& message) {
  write(writer, message.color);
  write(writer, message.depth);
  write(writer, message.color_info);
  write(writer, message.depth_info);
  writer.number(message.depth_unit_m);
  write_transform(writer, message.color_from_depth);
}

}  // namespace diminish::ros
