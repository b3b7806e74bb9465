#pragma once

#include <cstddef>
#include <vector>

#include "diminish/reconstructor.h"
#include "gl/buffer.h"
#include "gl/frame_block.h"

namespace diminish::gl {

/// Uploads a frame to the GPU: the RGB-D images and masks as they are, the cameras' places, and
/// whatever is added, in one piece of memory and one copy.
class FrameUpload {
 public:
  /// Create while the context is current. most_added_bytes: over all of a frame's calls of `add`.
  /// Throws Error if a camera's images are too large.
  FrameUpload(const Rig& rig, std::size_t most_added_bytes);

  /// Writes the frame into mapped memory. Needs no context. The GPU must be done with the last
  /// frame.
  void pack(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
            const OcclusionMasks& masks, const TiledRegion& region, const Options& options);
  /// Reserves a place that is sent with the frame, and returns where to write `bytes` to. begin:
  /// where the place begins on the GPU, in bytes; a multiple of `block_alignment`.
  std::byte* add(std::size_t bytes, std::size_t& begin);
  /// Copies everything to the GPU's own memory and binds it.
  void send();
  /// Binds the frame and the images (frame.glsl).
  void bind() const;
  /// Selects one of the cameras that take part.
  void bind_camera(int camera) const;
  /// Binds an added place as uniform block `binding`.
  void bind_block(GLuint binding, std::size_t begin, std::size_t bytes) const;

  /// The cameras that take part.
  int cameras() const { return static_cast<int>(blocks_.size()); }
  const CameraBlock& camera(int index) const { return blocks_[static_cast<std::size_t>(index)]; }

  /// Whether several cameras take part and are blended.
  bool blends() const { return frame_.most_blended > 0; }

  /// The number of depth pixels of all the rig's cameras, and each one's ray (x, y), in the rig's
  /// order.
  std::size_t depth_pixels() const { return depth_pixels_; }
  void bind_rays(GLuint unit) const { ray_texture_.bind(unit); }

 private:
  void upload_rays(const Rig& rig);

  std::vector<CameraBlock> of_rig_;  ///< with the constant parts
  std::vector<CameraBlock> blocks_;  ///< of the cameras that take part
  FrameBlock frame_{};
  std::size_t depth_pixels_ = 0;
  std::size_t bytes_ = 0;
  MappedBuffer mapped_{MappedBuffer::Use::upload};
  Buffer on_gpu_;
  Buffer rays_;
  BufferTexture word_texture_, ray_texture_;
};

}  // namespace diminish::gl
