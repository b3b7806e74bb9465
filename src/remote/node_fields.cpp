#include "remote/node_fields.h"

#include <cmath>

#include "core/limits.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "ros/pixel_encodings.h"

namespace diminish::node_fields {

using ros::MessageReader;
using ros::MessageWriter;

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

int integer(MessageReader& reader, int least, int most, const char* what) {
  const auto value = reader.number<std::int32_t>();
  expect(value >= least && value <= most, what);
  return value;
}

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

void write(MessageWriter& writer, const Rect& rect) {
  for (const int value : {rect.x, rect.y, rect.width, rect.height}) writer.number(value);
}

Rect read_rect(MessageReader& reader, const Rect& whole, const char* what) {
  Rect rect;
  for (int* value : {&rect.x, &rect.y, &rect.width, &rect.height}) {
    *value = integer(reader, 0, largest_side_px, what);
  }
  expect(rect.empty() || intersect(rect, whole) == rect, what);
  return rect;
}

bool flag(MessageReader& reader) {
  return reader.number<std::uint8_t>() != 0;
}

void write(MessageWriter& writer, const NodeHead& head) {
  writer.number(version);
  writer.number(static_cast<std::uint8_t>(head.topic));
  writer.number(head.user);
  writer.number(head.frame);
}

MessageWriter begin_answer(std::vector<std::uint8_t>& bytes, const AnswerHead& head) {
  MessageWriter writer(bytes, ros::Wire::cdr);
  write(writer, static_cast<const NodeHead&>(head));
  writer.number(head.asked_s);
  writer.number(head.received_s);
  writer.number(monotonic_now_s());
  writer.text(head.problem);
  return writer;
}

}  // namespace diminish::node_fields
