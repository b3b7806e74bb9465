#include <algorithm>
#include <vector>

#include "gl/lens_files.h"
#include "gl/reconstructor.h"

namespace diminish::gl {
namespace {

/// The name of a texture, framebuffer or the like; deleted with `destroy`.
template <auto* destroy>
class Name {
 public:
  Name() = default;
  ~Name() {
    if (value != 0) (*destroy)(1, &value);
  }
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;

  GLuint value = 0;
};

/// The paper's way (Meerits & Saito 2015, section 3.3): the graphics pipeline draws every cell of
/// the depth image, and its geometry shader removes triangles across depth edges and those that
/// face away. The driver decides which pixels a triangle covers, so results may differ where a
/// pixel's centre is within its rounding of an edge.
class GeometryRasterizer : public Rasterizer {
 public:
  GeometryRasterizer(const Rig& rig, const FrameUpload& /*upload*/)
      : picture_(rig.color),
        lens_files_(lens_files(rig)),
        program_({{GL_VERTEX_SHADER, vertex_files(rig, "geometry.vert"), {}},
                  {GL_GEOMETRY_SHADER, {"frame.glsl", "sdct.glsl", "geometry.geom"}, {}},
                  {GL_FRAGMENT_SHADER, {"frame.glsl", "texture.glsl", "geometry.frag"}, {}}}) {
    const GLsizei layers = static_cast<GLsizei>(std::max<std::size_t>(rig.rgbd.size(), 1));
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &seen_.value);
    glTextureStorage3D(seen_.value, 1, GL_RG32UI, picture_.width, picture_.height, layers);
    glTextureParameteri(seen_.value, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(seen_.value, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glCreateRenderbuffers(1, &depth_.value);
    glNamedRenderbufferStorage(depth_.value, GL_DEPTH_COMPONENT32F, picture_.width,
                               picture_.height);
    glCreateFramebuffers(1, &target_.value);
    glNamedFramebufferRenderbuffer(target_.value, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                   depth_.value);
    glCreateVertexArrays(1, &no_attributes_.value);
    for (const RgbdCamera& camera : rig.rgbd) {
      indices_.emplace_back(camera.depth);
    }
  }

  std::vector<std::string> seen_files() const override {
    std::vector<std::string> files = lens_files_;
    files.insert(files.end(), {"rule1.glsl", "seen_fragments.glsl"});
    return files;
  }

  void draw(const FrameUpload& upload, const Rect& region, const Buffer& /*work*/,
            PassTimer& timer) override {
    timer.measure("draw", [&] {
      glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.value);
      glViewport(0, 0, picture_.width, picture_.height);
      glEnable(GL_SCISSOR_TEST);
      glScissor(region.x, region.y, region.width, region.height);
      // Depth is near / z: larger is nearer.
      glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
      glEnable(GL_DEPTH_TEST);
      glDepthFunc(GL_GREATER);
      glBindVertexArray(no_attributes_.value);
      upload.bind_rays(4);
      program_.use();
      glProgramUniform2f(program_.name(), program_.location("picture_size"),
                         static_cast<float>(picture_.width), static_cast<float>(picture_.height));
      for (int camera = 0; camera < upload.cameras(); ++camera) draw_camera(upload, camera);
      glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
      glDisable(GL_SCISSOR_TEST);
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    });
  }

  void bind_seen() const override { glBindTextureUnit(0, seen_.value); }

 private:
  /// The cells of a depth image, two triangles each (rule 2 of sdct.h).
  struct Indices {
    explicit Indices(const Intrinsics& depth) {
      std::vector<std::uint32_t> all;
      const auto width = static_cast<std::uint32_t>(depth.width);
      for (std::uint32_t y = 0; y + 1 < static_cast<std::uint32_t>(depth.height); ++y) {
        for (std::uint32_t x = 0; x + 1 < width; ++x) {
          const std::uint32_t a = y * width + x;
          all.insert(all.end(), {a, a + 1, a + width, a + 1, a + width + 1, a + width});
        }
      }
      count = static_cast<GLsizei>(all.size());
      name.create();
      glNamedBufferStorage(name.get(), static_cast<GLsizeiptr>(all.size() * sizeof(all[0])),
                           all.data(), 0);
    }

    BufferName name;
    GLsizei count = 0;
  };

  void draw_camera(const FrameUpload& upload, int camera) const {
    glNamedFramebufferTextureLayer(target_.value, GL_COLOR_ATTACHMENT0, seen_.value, 0, camera);
    const GLuint nothing[4] = {};
    const GLfloat farthest = 0;
    glClearNamedFramebufferuiv(target_.value, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(target_.value, GL_DEPTH, 0, &farthest);
    upload.bind_camera(camera);
    const Indices& indices = indices_[upload.camera(camera).source - 1];
    glVertexArrayElementBuffer(no_attributes_.value, indices.name.get());
    glDrawElements(GL_TRIANGLES, indices.count, GL_UNSIGNED_INT, nullptr);
  }

  Intrinsics picture_;
  std::vector<std::string> lens_files_;
  Program program_;
  std::vector<Indices> indices_;  ///< one for each of the rig's cameras
  Name<&glDeleteTextures> seen_;
  Name<&glDeleteRenderbuffers> depth_;
  Name<&glDeleteFramebuffers> target_;
  Name<&glDeleteVertexArrays> no_attributes_;
};

const bool geometry_rasterizer_registered =
    Registry<Reconstructor>::add("gl_geometry", [](const Rig& rig) {
      return std::make_unique<GlReconstructor>(rig, [](const Rig& r, const FrameUpload& upload) {
        return std::make_unique<GeometryRasterizer>(r, upload);
      });
    });

}  // namespace
}  // namespace diminish::gl
