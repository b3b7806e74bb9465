#include "gl/reconstructor.h"

#include <algorithm>
#include <array>

#include "reconstruct/clear_outside.h"

namespace diminish::gl {
namespace {

std::vector<std::string> files(const Rasterizer& rasterizer, const char* last) {
  std::vector<std::string> names = {"frame.glsl", "sdct.glsl", "texture.glsl", "work.glsl"};
  for (std::string& name : rasterizer.seen_files()) names.push_back(std::move(name));
  names.emplace_back(last);
  return names;
}

std::size_t pixels_of(const Rect& region) {
  return static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
}

/// A pixel as color.comp leaves it.
struct ResultPixel {
  std::uint8_t b, g, r;
  std::uint8_t place;  ///< among the cameras that take part, from 1 on; 0: nothing
  float depth_m;
};

}  // namespace

struct GlReconstructor::Resources {
  Resources(const Context& context, const Rig& rig, const MakeRasterizer& make_rasterizer)
      : upload(rig),
        rasterizer(make_rasterizer(rig, upload)),
        count(compute_program(files(*rasterizer, "count.comp"))),
        order(compute_program({"frame.glsl", "work.glsl", "order.comp"})),
        merge(compute_program(files(*rasterizer, "merge.comp"))),
        color(compute_program(files(*rasterizer, "color.comp"))),
        timer(context.driver().software) {
    const std::size_t bytes = pixels_of(rig.color.bounds()) * sizeof(ResultPixel);
    work.reserve(std::max<std::size_t>(rig.rgbd.size(), 1) * sizeof(WorkBlock));
    result.reserve(bytes);
    downloaded.reserve(bytes);
  }

  FrameUpload upload;
  std::unique_ptr<Rasterizer> rasterizer;
  Program count, order, merge, color;
  Buffer work, result;
  MappedBuffer downloaded{MappedBuffer::Use::download};
  PassTimer timer;
};

GlReconstructor::GlReconstructor(const Rig& rig, const MakeRasterizer& make_rasterizer)
    : color_(rig.color), device_(context_.driver().name) {
  const Current current(context_);
  resources_ = std::make_unique<Resources>(context_, rig, make_rasterizer);
  context_.check("making programs and buffers");
}

GlReconstructor::~GlReconstructor() {
  delete_in(context_, resources_);
}

void GlReconstructor::reconstruct(const FrameSet& frame, const DepthImages& depths,
                                  const Poses& poses, const OcclusionMasks& masks,
                                  const TiledRegion& region, const Options& options,
                                  Reconstruction& reconstruction) {
  passes_.clear();
  clear_outside(color_, region, reconstruction);
  resources_->upload.pack(frame, depths, poses, masks, region, options);
  if (region.empty() || resources_->upload.cameras() == 0) {
    reconstruction.color.fill(region, {});
    reconstruction.depth_m.fill(region, 0.F);
    reconstruction.source.fill(region, 0);
    return;
  }
  {
    const Current current(context_);
    draw(region);
    wait_until_done();
    context_.check("reconstruction");
    resources_->timer.read(passes_);
  }
  std::array<std::uint8_t, 256> sources{};
  for (int k = 0; k < resources_->upload.cameras(); ++k) {
    sources[static_cast<std::size_t>(k + 1)] =
        static_cast<std::uint8_t>(resources_->upload.camera(k).source);
  }
  const auto* pixel = reinterpret_cast<const ResultPixel*>(resources_->downloaded.data());
  for (int y = region.y; y < region.bottom(); ++y) {
    Bgra* const color = reconstruction.color.row(y) + region.x;
    float* const depth_m = reconstruction.depth_m.row(y) + region.x;
    std::uint8_t* const source = reconstruction.source.row(y) + region.x;
    for (int x = 0; x < region.width; ++x, ++pixel) {
      const auto alpha = static_cast<std::uint8_t>(pixel->place != 0 ? 255 : 0);
      color[x] = {pixel->b, pixel->g, pixel->r, alpha};
      depth_m[x] = pixel->depth_m;
      source[x] = sources[pixel->place];
    }
  }
}

void GlReconstructor::draw(const Rect& region) {
  Resources& r = *resources_;
  // Rows of pixels, 64 at a time.
  const auto dispatch = [&] {
    glDispatchCompute(static_cast<GLuint>((region.width + 63) / 64),
                      static_cast<GLuint>(region.height), 1);
  };
  const int cameras = r.upload.cameras();
  r.timer.begin_frame();
  r.timer.measure("upload", [&] {
    r.upload.send();
    const GLuint zero = 0;
    glClearNamedBufferData(r.work.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
    // Both lists: no groups (whose second and third dimensions are 1), no triangles.
    const GLuint none[4] = {0, 1, 1, 0};
    for (int k = 0; k < cameras; ++k) {
      glClearNamedBufferSubData(r.work.name(), GL_RGBA32UI,
                                static_cast<GLintptr>(k) * static_cast<GLintptr>(sizeof(WorkBlock)),
                                2 * sizeof(none), GL_RGBA_INTEGER, GL_UNSIGNED_INT, none);
    }
  });
  r.rasterizer->draw(r.upload, region, r.work, r.timer);
  r.rasterizer->bind_seen();
  r.result.bind(7);
  r.timer.measure("merge", [&] {
    for (int k = 0; k < cameras && cameras > 1; ++k) {
      r.upload.bind_camera(k);
      bind_work(r.work, k);
      r.count.use();
      dispatch();
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    r.work.bind(1);
    // One camera's turn is the first: that is what the block holds already.
    if (cameras > 1) {
      r.order.use();
      glDispatchCompute(1, 1, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
    r.merge.use();
    dispatch();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  });
  r.timer.measure("color", [&] {
    r.color.use();
    for (int k = 0; k < cameras; ++k) {
      r.upload.bind_camera(k);
      dispatch();
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  });
  r.timer.measure("download", [&] {
    copy(r.result.name(), r.downloaded.name(), pixels_of(region) * sizeof(ResultPixel));
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
  });
}

}  // namespace diminish::gl
