#include <algorithm>
#include <cstddef>

#include "gl/lens_files.h"
#include "gl/reconstructor.h"

namespace diminish::gl {
namespace {

/// The default: rules 1 to 5 of sdct.h in compute shaders, with the CPU's rounding. Lists the
/// surviving triangles, and draws as many as the list holds.
class ComputeRasterizer : public Rasterizer {
 public:
  ComputeRasterizer(const Rig& rig, const FrameUpload& upload)
      : vertices_(compute_program(vertex_files(rig, "vertices.comp"))),
        cells_(compute_program(drawing("cells.comp"))),
        nearest_small_(compute_program(drawing("draw_small.comp"), "#define FIND_NEAREST\n")),
        nearest_large_(compute_program(drawing("draw_large.comp"), "#define FIND_NEAREST\n")),
        seen_small_(compute_program(drawing("draw_small.comp"))),
        seen_large_(compute_program(drawing("draw_large.comp"))) {
    const std::size_t pixels = std::max<std::size_t>(upload.depth_pixels(), 1);
    positions_.reserve(pixels * 16);
    places_.reserve(pixels * 8);
    triangles_.reserve(2 * pixels * 4);
    position_texture_.create(positions_, GL_RGBA32I, pixels);
    place_texture_.create(places_, GL_RG32F, pixels);
    triangle_texture_.create(triangles_, GL_R32UI, 2 * pixels);
    layers_.reserve(std::max<std::size_t>(rig.rgbd.size(), 1) * 8 *
                    static_cast<std::size_t>(rig.color.width) *
                    static_cast<std::size_t>(rig.color.height));
  }

  std::vector<std::string> seen_files() const override {
    return {"vertices.glsl", "triangles.glsl", "seen_triangles.glsl"};
  }

  void draw(const FrameUpload& upload, const Rect& region, const Buffer& work,
            PassTimer& timer) override {
    positions_.bind(2);
    places_.bind(3);
    timer.measure("vertices", [&] {
      upload.bind_rays(4);
      vertices_.use();
      for (int k = 0; k < upload.cameras(); ++k) {
        upload.bind_camera(k);
        glDispatchCompute(groups_of(upload.camera(k)), 1, 1);
      }
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    });
    bind_seen();
    triangles_.bind(5);
    triangle_texture_.bind(5);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, work.name());
    for (int k = 0; k < upload.cameras(); ++k) {
      upload.bind_camera(k);
      bind_work(work, k);
      timer.measure("cells", [&] {
        cells_.use();
        const CameraBlock& camera = upload.camera(k);
        glDispatchCompute(static_cast<GLuint>((camera.depth_width + 63) / 64),
                          static_cast<GLuint>(std::max(camera.depth_height - 1, 0)), 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                        GL_COMMAND_BARRIER_BIT);
      });
      timer.measure("draw", [&] {
        const GLuint nothing[2] = {0, ~0U};
        const GLsizeiptr bytes = GLsizeiptr{8} * region.width * region.height;
        glClearNamedBufferSubData(layers_.name(), GL_RG32UI, k * bytes, bytes, GL_RG_INTEGER,
                                  GL_UNSIGNED_INT, nothing);
        draw_lists(nearest_small_, nearest_large_, k);
        draw_lists(seen_small_, seen_large_, k);
      });
    }
  }

  void bind_seen() const override {
    position_texture_.bind(2);
    place_texture_.bind(3);
    layers_.bind(6);
  }

 private:
  static std::vector<std::string> drawing(const char* last) {
    return {"frame.glsl", "sdct.glsl", "vertices.glsl", "work.glsl", "triangles.glsl", last};
  }

  static GLuint groups_of(const CameraBlock& camera) {
    return static_cast<GLuint>((camera.depth_width * camera.depth_height + 63) / 64);
  }

  static void draw_lists(const Program& small, const Program& large, int camera) {
    const auto at = static_cast<GLintptr>(camera) * static_cast<GLintptr>(sizeof(WorkBlock));
    small.use();
    glDispatchComputeIndirect(at + static_cast<GLintptr>(offsetof(WorkBlock, small_groups)));
    large.use();
    glDispatchComputeIndirect(at + static_cast<GLintptr>(offsetof(WorkBlock, large_groups)));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  Program vertices_, cells_, nearest_small_, nearest_large_, seen_small_, seen_large_;
  Buffer positions_, places_, triangles_, layers_;
  BufferTexture position_texture_, place_texture_, triangle_texture_;
};

std::unique_ptr<Reconstructor> make(const Rig& rig) {
  return std::make_unique<GlReconstructor>(rig, [](const Rig& r, const FrameUpload& upload) {
    return std::make_unique<ComputeRasterizer>(r, upload);
  });
}

Reconstructor::Suited suited() {
  static const bool is_hardware_there = has_hardware_driver();
  using Suited = Reconstructor::Suited;
  return is_hardware_there ? Suited::with_hardware : Suited::when_named;
}

const bool compute_rasterizer_registered = Registry<Reconstructor>::add("gl", {make, suited});

}  // namespace
}  // namespace diminish::gl
