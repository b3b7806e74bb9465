#include "gl/frame_upload.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "blend/layers.h"
#include "core/rows.h"
#include "diminish/error.h"
#include "geometry/ray_table.h"
#include "render/sdct.h"

namespace diminish::gl {
namespace {

/// The most groups of 64 in one dispatch.
constexpr std::size_t most_depth_pixels_of_a_camera = std::size_t{64} * 65535;

/// The frame's block, then the cameras'.
constexpr std::size_t block_at(std::size_t index) {
  return index * block_alignment;
}

std::size_t whole_words(std::size_t bytes) {
  return (bytes + 3) / 4 * 4;
}

template <class Pixel>
std::size_t bytes_of(const Intrinsics& intrinsics) {
  return whole_words(sizeof(Pixel) * static_cast<std::size_t>(intrinsics.width) *
                     static_cast<std::size_t>(intrinsics.height));
}

}  // namespace

FrameUpload::FrameUpload(const Rig& rig, std::size_t most_added_bytes) {
  if (rig.rgbd.size() > most_cameras) {
    throw Error(Error::device, fmt::format("gl: expected at most {} RGB-D cameras", most_cameras));
  }
  frame_.color = LensBlock(Projection(Lens(rig.color)));
  std::size_t bytes = block_at(1 + rig.rgbd.size());
  for (const RgbdCamera& camera : rig.rgbd) {
    CameraBlock block{};
    block.rgbd_color = LensBlock(Projection(Lens(camera.color)));
    block.rgbd_color_from_depth = TransformBlock(FloatTransform(camera.color_from_depth));
    block.unit_m = static_cast<float>(camera.depth_unit_m);
    block.depth_width = camera.depth.width;
    block.depth_height = camera.depth.height;
    block.color_width = camera.color.width;
    block.color_height = camera.color.height;
    block.first_pixel = static_cast<std::uint32_t>(depth_pixels_);
    const std::size_t pixels = static_cast<std::size_t>(camera.depth.width) *
                               static_cast<std::size_t>(camera.depth.height);
    if (pixels > most_depth_pixels_of_a_camera) {
      throw Error(Error::device, fmt::format("gl: {}: expected a depth image of at most {} pixels",
                                             camera.name, most_depth_pixels_of_a_camera));
    }
    depth_pixels_ += pixels;
    bytes += bytes_of<std::uint16_t>(camera.depth) + bytes_of<std::uint8_t>(camera.depth) +
             bytes_of<std::uint8_t>(camera.color) + bytes_of<Bgr>(camera.color);
    of_rig_.push_back(block);
  }
  constexpr int tile = TiledRegion::tile;
  bytes += whole_words(static_cast<std::size_t>(rig.color.width / tile + 1) *
                       static_cast<std::size_t>(rig.color.height / tile + 1));
  // A pixel's last byte is read together with the next word.
  bytes += 4 + most_added_bytes;
  mapped_.reserve(bytes);
  on_gpu_.reserve(bytes);
  word_texture_.create(on_gpu_, GL_R32UI, bytes / 4);
  upload_rays(rig);
}

void FrameUpload::upload_rays(const Rig& rig) {
  std::vector<Eigen::Vector2f> all;
  all.reserve(depth_pixels_);
  for (const RgbdCamera& camera : rig.rgbd) {
    const std::shared_ptr<const RayTable> rays = RayTable::of(camera.depth);
    for (int y = 0; y < rays->height(); ++y) {
      for (int x = 0; x < rays->width(); ++x) all.push_back((*rays)(x, y));
    }
  }
  const std::size_t bytes = all.size() * sizeof(Eigen::Vector2f);
  rays_.reserve(std::max<std::size_t>(bytes, 4));
  ray_texture_.create(rays_, GL_RG32F, all.size());
  MappedBuffer staging(MappedBuffer::Use::upload);
  staging.reserve(std::max<std::size_t>(bytes, 4));
  std::memcpy(staging.data(), reinterpret_cast<const float*>(all.data()), bytes);
  copy(staging.name(), rays_.name(), bytes);
  wait_until_done();
}

void FrameUpload::pack(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                       const OcclusionMasks& masks, const TiledRegion& region,
                       const Options& options) {
  blocks_.clear();
  std::size_t at = block_at(1 + of_rig_.size());
  const auto append = [&]<class Pixel>(const ImageView<Pixel>& image) {
    const std::size_t start = at;
    const std::size_t row_bytes = static_cast<std::size_t>(image.width()) * sizeof(Pixel);
    for_rows(image.height(), [&](Rows rows) {
      for (int y = rows.first; y < rows.last; ++y) {
        std::memcpy(mapped_.data() + start + static_cast<std::size_t>(y) * row_bytes, image.row(y),
                    row_bytes);
      }
    });
    at = start + whole_words(static_cast<std::size_t>(image.height()) * row_bytes);
    return static_cast<std::uint32_t>(start / 4);
  };
  for (std::size_t k = 0; k < of_rig_.size(); ++k) {
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
    CameraBlock block = of_rig_[k];
    block.color_from_depth = TransformBlock(FloatTransform(*poses.color_from_depth[k]));
    block.depth_at = append(ImageView(depths[k]));
    block.depth_mask_at = append(ImageView(masks.rgbd_depth[k]));
    block.color_mask_at = append(ImageView(masks.rgbd_color[k]));
    block.color_at = append(frame.rgbd[k].color.view());
    block.source = static_cast<std::uint32_t>(k + 1);
    block.layer = static_cast<std::uint32_t>(blocks_.size());
    std::memcpy(mapped_.data() + block_at(1 + blocks_.size()), &block, sizeof(block));
    blocks_.push_back(block);
  }
  const Rect tiles = region.tiles();
  frame_.tiles_x = tiles.x;
  frame_.tiles_y = tiles.y;
  frame_.tiles_width = tiles.width;
  const std::vector<std::uint8_t>& kept = region.kept_tiles();
  frame_.tiles_at = append(ImageView(kept.data(), static_cast<int>(kept.size()), 1, 0));
  bytes_ = at + 4;

  const sdct::Threshold threshold(options.discontinuity_threshold_m, options.discontinuity_reach_m);
  frame_.region_x = region.x;
  frame_.region_y = region.y;
  frame_.region_width = region.width;
  frame_.region_height = region.height;
  frame_.threshold_m = threshold.constant_m;
  frame_.inverse_reach = threshold.inverse_reach;
  frame_.agreement_m = static_cast<float>(options.depth_agreement_m);
  const bool blends = blocks_.size() > 1 && options.merge_cameras == "blend";
  frame_.most_blended = blends ? blending::most_cameras : 0;
  frame_.camera_count = static_cast<std::uint32_t>(blocks_.size());
  std::memcpy(mapped_.data(), &frame_, sizeof(frame_));
}

std::byte* FrameUpload::add(std::size_t bytes, std::size_t& begin) {
  begin = (bytes_ + block_alignment - 1) / block_alignment * block_alignment;
  bytes_ = begin + whole_words(bytes);
  return mapped_.data() + begin;
}

void FrameUpload::send() {
  copy(mapped_.name(), on_gpu_.name(), bytes_);
  bind();
}

void FrameUpload::bind() const {
  word_texture_.bind(1);
  bind_block(0, 0, sizeof(FrameBlock));
}

void FrameUpload::bind_camera(int camera) const {
  bind_block(1, block_at(1 + static_cast<std::size_t>(camera)), sizeof(CameraBlock));
}

void FrameUpload::bind_block(GLuint binding, std::size_t begin, std::size_t bytes) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, binding, on_gpu_.name(), static_cast<GLintptr>(begin),
                    static_cast<GLsizeiptr>(bytes));
}

}  // namespace diminish::gl
