#include "gl/reconstructor.h"

#include <algorithm>
#include <optional>

#include "composite/object_pixels.h"
#include "core/rows.h"
#include "gl/camera_blending.h"
#include "gl/frame_compositor.h"
#include "gl/picture_textures.h"
#include "gl/result_pixel.h"
#include "reconstruct/clear_outside.h"

namespace diminish::gl {
namespace {

std::vector<std::string> files(const Rasterizer& rasterizer, const char* last) {
  std::vector<std::string> names = files_before(rasterizer.seen_files());
  names.emplace_back(last);
  return names;
}

/// Gives the reconstruction its region, and as much memory as will be filled.
void begin(const Rig& rig, const FrameInputs& inputs, Stage last, DiminishedFrame& result) {
  Reconstruction& reconstruction = result.reconstruction;
  result.surfaces.region = static_cast<const Rect&>(inputs.region);
  result.surfaces.label.resize(0, 0);
  result.surfaces.light.resize(0, 0);
  if (FrameCompositor::gives_reconstruction(inputs, last)) {
    return clear_outside(rig.color, inputs.region, reconstruction);
  }
  reconstruction.region = inputs.region;
  reconstruction.color.resize(0, 0);
  reconstruction.depth_m.resize(0, 0);
  reconstruction.source.resize(0, 0);
}

/// Where results are downloaded to: the first cameras' pixels, then the second ones'.
std::size_t end_of_first(const Rect& region) {
  return pixels_of(region) * sizeof(ResultPixel);
}

/// Shows the camera's picture: all that is to be seen where nothing is removed, and else what is
/// around the region. textures: null where the picture goes to the result.
void show_camera(const FrameInputs& inputs, PictureTextures* textures, DiminishedFrame& result) {
  const ImageView<Bgr> camera = inputs.frame.color;
  const Rect given = textures ? Rect{} : camera.bounds();
  result.picture.resize(given.width, given.height);
  set_objects(inputs.masks.color, inputs.objects, given, result);
  if (textures) return textures->pack(camera);
  for_rows(camera.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      std::copy_n(camera.row(y), camera.width(), result.picture.row(y));
    }
  });
}

}  // namespace

struct GlReconstructor::Resources {
  Resources(const Context& context, const Rig& rig, const MakeRasterizer& make_rasterizer)
      : upload(rig, FrameCompositor::most_added_bytes(rig) + CameraBlending::most_added_bytes),
        rasterizer(make_rasterizer(rig, upload)),
        count(compute_program(files(*rasterizer, "count.comp"))),
        order(compute_program({"frame.glsl", "work.glsl", "order.comp"})),
        merge(compute_program(files(*rasterizer, "merge.comp"))),
        color(compute_program(files(*rasterizer, "color.comp"))),
        timer(context.driver().software) {
    work.reserve(std::max<std::size_t>(rig.rgbd.size(), 1) * sizeof(WorkBlock));
    // Bound also where nothing is blended.
    result.second.reserve(sizeof(SecondPixel));
    result.first.reserve(pixels_of(rig.color.bounds()) * sizeof(ResultPixel));
  }

  FrameUpload upload;
  std::unique_ptr<Rasterizer> rasterizer;
  Program count, order, merge, color;
  Buffer work;
  ResultBuffers result;
  MappedBuffer downloaded{MappedBuffer::Use::download};
  std::optional<CameraBlending> blending;     ///< from the first frame on that is blended
  std::optional<FrameCompositor> compositor;  ///< from the first frame on that is composed
  PassTimer timer;
};

GlReconstructor::GlReconstructor(const Rig& rig, const MakeRasterizer& make_rasterizer)
    : rig_(rig), make_rasterizer_(make_rasterizer), device_(context_.driver().name) {
  make_resources();
}

GlReconstructor::~GlReconstructor() {
  context_.run([&] { resources_.reset(); });
}

void GlReconstructor::make_resources() {
  context_.run([&] {
    resources_ = std::make_unique<Resources>(context_, rig_, make_rasterizer_);
    context_.check("making programs and buffers");
  });
}

/// A context cannot begin to share: it is made anew.
void GlReconstructor::share_with(const Context& other) {
  if (context_.shares_with(other)) return;
  context_.run([&] { resources_.reset(); });
  context_ = Context::sharing_with(other);
  device_ = context_.driver().name;
  make_resources();
}

void GlReconstructor::reconstruct(const FrameSet& frame, const DepthImages& depths,
                                  const Poses& poses, const OcclusionMasks& masks,
                                  const TiledRegion& region, const Options& options,
                                  Reconstruction& reconstruction) {
  passes_.clear();
  clear_outside(rig_.color, region, reconstruction);
  resources_->upload.pack(frame, depths, poses, masks, region, options);
  const bool blends = !region.empty() && resources_->upload.blends();
  resize_second(blends, rig_.color, reconstruction.second);
  if (region.empty() || resources_->upload.cameras() == 0) {
    reconstruction.color.fill(region, {});
    reconstruction.depth_m.fill(region, 0.F);
    reconstruction.source.fill(region, 0);
    return;
  }
  Resources& r = *resources_;
  prepare_blending();
  const std::size_t second_at = end_of_first(region);
  context_.run([&] {
    r.downloaded.reserve((blends ? 2 : 1) * end_of_first(rig_.color.bounds()));
    draw(region);
    r.timer.measure("download", [&] {
      glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
      copy(r.result.first.name(), r.downloaded.name(), second_at);
      if (blends) copy(r.result.second.name(), r.downloaded.name(), second_at, second_at);
      glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    });
    wait_until_done();
    context_.check("reconstruction");
    r.timer.read(passes_);
  });
  const std::byte* const from = r.downloaded.data();
  unpack(reinterpret_cast<const ResultPixel*>(from),
         reinterpret_cast<const SecondPixel*>(from + second_at), r.upload, reconstruction);
}

bool GlReconstructor::takes_over(Stage stage, const FrameMethods& methods) const {
  return FrameCompositor::takes_over(stage, methods);
}

std::string GlReconstructor::mask_drawer() const {
  // A software driver would only take longer.
  return context_.driver().software ? Reconstructor::mask_drawer() : "gl";
}

void GlReconstructor::compose(const FrameInputs& inputs, Stage last, DiminishedFrame& result) {
  passes_.clear();
  auto* const textures = FrameCompositor::gives_picture(inputs, last)
                             ? nullptr
                             : &dynamic_cast<PictureTextures&>(*inputs.texture);
  if (textures) share_with(textures->context());
  Resources& r = *resources_;
  const TiledRegion& region = inputs.region;
  begin(rig_, inputs, last, result);
  if (region.empty()) {
    resize_second(false, rig_.color, result.reconstruction.second);
    show_camera(inputs, textures, result);
    if (textures) textures->upload(inputs.frame.color);
    return;
  }
  if (!r.compositor) {
    context_.run([&] {
      r.compositor.emplace(rig_);
      context_.check("making the compositor's programs and buffers");
    });
  }
  r.upload.pack(inputs.frame, inputs.depths, inputs.poses, inputs.masks, region, inputs.options);
  resize_second(r.upload.blends() && FrameCompositor::gives_reconstruction(inputs, last),
                rig_.color, result.reconstruction.second);
  prepare_blending();
  r.compositor->pack(inputs, last, r.upload);
  context_.run([&] {
    draw(region);
    r.compositor->run(inputs, r.upload, r.result, r.timer);
    glFlush();
  });
  // While the GPU works.
  show_camera(inputs, textures, result);
  context_.run([&] {
    if (textures) {
      r.timer.measure("texture", [&] {
        textures->draw_packed();
        textures->draw_region(r.compositor->picture(), region);
      });
    }
    wait_until_done();
    context_.check("composing a frame");
    if (textures) textures->publish();
    r.timer.read(passes_);
  });
  r.compositor->read(inputs, r.upload, result);
}

/// After the upload has packed the frame.
void GlReconstructor::prepare_blending() {
  Resources& r = *resources_;
  if (!r.upload.blends()) return;
  if (!r.blending) {
    context_.run([&] {
      r.blending.emplace(rig_, r.rasterizer->seen_files());
      r.result.second.reserve(pixels_of(rig_.color.bounds()) * sizeof(SecondPixel));
      context_.check("making the blending's programs and buffers");
    });
  }
  r.blending->pack(r.upload);
}

void GlReconstructor::draw(const Rect& region) {
  Resources& r = *resources_;
  // Rows of pixels, 64 at a time.
  const auto dispatch = [&] {
    glDispatchCompute(static_cast<GLuint>((region.width + 63) / 64),
                      static_cast<GLuint>(region.height), 1);
  };
  const int cameras = r.upload.cameras();
  const bool blends = r.upload.blends();
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
  r.result.first.bind(7);
  r.result.second.bind(0);
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
    if (blends && CameraBlending::surely_blends(r.upload)) return;
    r.merge.use();
    dispatch();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  });
  if (blends) return r.blending->run(r.upload, region, r.work, r.timer);
  r.timer.measure("color", [&] {
    r.color.use();
    for (int k = 0; k < cameras; ++k) {
      r.upload.bind_camera(k);
      dispatch();
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  });
}

}  // namespace diminish::gl
