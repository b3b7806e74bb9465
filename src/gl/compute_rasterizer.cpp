#include <algorithm>

#include "gl/reconstructor.h"

namespace diminish::gl {
namespace {

/// The default: rules 1 to 5 of sdct.h in compute shaders, to the rounding what the processor does.
/// Surviving triangles are listed, and drawn by what the list's length asks for.
class ComputeRasterizer : public Rasterizer {
 public:
  ComputeRasterizer(const Rig& rig, const FrameUpload& upload)
      : vertices_(compute_program(
            {"frame.glsl", "sdct.glsl", "vertices.glsl", "rule1.glsl", "vertices.comp"})),
        cells_(compute_program(drawing("cells.comp"))),
        nearest_small_(compute_program(drawing("draw_small.comp"), "#define FIND_NEAREST\n")),
        nearest_large_(compute_program(drawing("draw_large.comp"), "#define FIND_NEAREST\n")),
        seen_small_(compute_program(drawing("draw_small.comp"))),
        seen_large_(compute_program(drawing("draw_large.comp"))) {
    const std::size_t pixels = std::max<std::size_t>(upload.depth_pixels(), 1);
    positions_.reserve(pixels * 16);
    places_.reserve(pixels * 8);
    triangles_.reserve(2 * pixels * 4);
    layers_.reserve(std::max<std::size_t>(rig.rgbd.size(), 1) * 8 *
                    static_cast<std::size_t>(rig.color.width) *
                    static_cast<std::size_t>(rig.color.height));
  }

  std::vector<std::string> seen_files() const override {
    return {"vertices.glsl", "triangles.glsl", "seen_triangles.glsl"};
  }

  void draw(const FrameUpload& upload, const Rect& region, PassTimer& timer) override {
    const auto groups = static_cast<GLuint>((upload.most_depth_pixels() + 63) / 64);
    const auto cameras = static_cast<GLuint>(upload.cameras());
    positions_.bind(2);
    places_.bind(3);
    timer.measure("vertices", [&] {
      upload.bind_rays(5);
      vertices_.use();
      glDispatchCompute(groups, cameras, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    });
    bind_seen();
    timer.measure("cells", [&] {
      cells_.use();
      glDispatchCompute(groups, cameras, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    });
    timer.measure("draw", [&] {
      const GLuint nothing[2] = {0, ~0U};
      glClearNamedBufferSubData(layers_.name(), GL_RG32UI, 0,
                                static_cast<GLsizeiptr>(cameras) * region.width * region.height * 8,
                                GL_RG_INTEGER, GL_UNSIGNED_INT, nothing);
      GLint work = 0;
      glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 4, &work);
      glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, static_cast<GLuint>(work));
      draw_list(nearest_small_, nearest_large_);
      draw_list(seen_small_, seen_large_);
    });
  }

  void bind_seen() const override {
    positions_.bind(2);
    places_.bind(3);
    triangles_.bind(5);
    layers_.bind(6);
  }

 private:
  static std::vector<std::string> drawing(const char* last) {
    return {"frame.glsl", "sdct.glsl", "vertices.glsl", "work.glsl", "triangles.glsl", last};
  }

  static void draw_list(const Program& small, const Program& large) {
    small.use();
    glDispatchComputeIndirect(0);
    large.use();
    glDispatchComputeIndirect(16);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  Program vertices_, cells_, nearest_small_, nearest_large_, seen_small_, seen_large_;
  Buffer positions_, places_, triangles_, layers_;
};

const bool registered = Registry<Reconstructor>::add("gl", [](const Rig& rig) {
  return std::make_unique<GlReconstructor>(rig, [](const Rig& r, const FrameUpload& upload) {
    return std::make_unique<ComputeRasterizer>(r, upload);
  });
});

}  // namespace
}  // namespace diminish::gl
