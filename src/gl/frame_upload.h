#pragma once

#include <cstddef>
#include <vector>

#include "diminish/reconstructor.h"
#include "gl/buffer.h"
#include "gl/frame_block.h"

namespace diminish::gl {

/// A frame's way to the GPU: the RGB-D images and masks as they are, where the cameras are, and
/// what is added to it, in one piece of memory and one copy.
class FrameUpload {
 public:
  /// Made while the context is current. most_added_bytes: by all of a frame's calls of `add`.
  /// Throws Error where a camera's images are too large.
  FrameUpload(const Rig& rig, std::size_t most_added_bytes);

  /// Writes the frame into mapped memory; needs no context. The GPU must be done with the last.
  void pack(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
            const OcclusionMasks& masks, const TiledRegion& region, const Options& options);
  /// A place that is sent with the frame: where to write `bytes` to. begin: where the place begins
  /// on the GPU, in bytes; a multiple of `block_alignment`.
  std::byte* add(std::size_t bytes, std::size_t& begin);
  /// Copies it to the GPU's own memory, and binds it.
  void send();
  /// Binds the frame and the images (frame.glsl).
  void bind() const;
  /// Makes it the turn of one of the cameras that take part.
  void bind_camera(int camera) const;
  /// Binds what was added as uniform block `binding`.
  void bind_block(GLuint binding, std::size_t begin, std::size_t bytes) const;

  /// The cameras that take part.
  int cameras() const { return static_cast<int>(blocks_.size()); }
  const CameraBlock& camera(int index) const { return blocks_[static_cast<std::size_t>(index)]; }

  /// Whether several cameras take part and are to be blended.
  bool blends() const { return frame_.most_blended > 0; }

  /// Depth pixels of all the rig's cameras, and every one's ray (x, y), in the rig's order.
  std::size_t depth_pixels() const { return depth_pixels_; }
  void bind_rays(GLuint unit) const { ray_texture_.bind(unit); }

 private:
  void upload_rays(const Rig& rig);

  std::vector<CameraBlock> of_rig_;  ///< with what does not change
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
