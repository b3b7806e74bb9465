#include "gl/frame_compositor.h"

#include <cstring>

#include "composite/soft_rim.h"
#include "core/rows.h"
#include "gl/composition_rules.h"
#include "membrane/soft_membrane.h"
#include "reconstruct/clear_outside.h"

namespace diminish::gl {
namespace {

Program composition_pass(std::vector<std::string> files, const char* define = "") {
  files.insert(files.begin(), {"frame.glsl", "composition.glsl"});
  return compute_program(std::move(files), composition_rules() + define);
}

std::string mode_file(const std::string& mode) {
  return "mode_" + mode + ".glsl";
}

/// Shows the background, and nothing else.
constexpr const char* plain_mode = "mode_remove.glsl";

constexpr std::size_t cells_of_a_shadow =
    std::size_t{CastShadow::grid_cells} * CastShadow::grid_cells;
using Light = Eigen::Array3f;
static_assert(sizeof(Light) == 3 * sizeof(float));

/// The camera's pixels, and the objects' mask in the highest byte.
void pack_picture(ImageView<Bgr> camera, const Mask& mask, const Rect& region, std::byte* to) {
  auto* const words = reinterpret_cast<std::uint32_t*>(to);
  for_rows(region.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const Bgr* colors = camera.row(region.y + y) + region.x;
      const std::uint8_t* removed = mask.row(region.y + y) + region.x;
      std::uint32_t* row = words + static_cast<std::ptrdiff_t>(y) * region.width;
      for (int x = 0; x < region.width; ++x) {
        const std::uint32_t is_removed = removed[x] != 0 ? 0xFF000000U : 0U;
        row[x] = colors[x].b | static_cast<std::uint32_t>(colors[x].g) << 8 |
                 static_cast<std::uint32_t>(colors[x].r) << 16 | is_removed;
      }
    }
  });
}

}  // namespace

bool FrameCompositor::takes_over(Stage stage, const FrameMethods& methods) {
  using ColorRule = ColorCorrector::Declaration::Rule;
  using FillingRule = Inpainter::Declaration::Rule;
  switch (stage) {
    case Stage::merging:
      return !methods.remembers;
    case Stage::compositing:
    case Stage::colors:
      return methods.color.rule != ColorRule::own;
    case Stage::inpainting:
    case Stage::finish:
      return methods.inpainting.rule != FillingRule::own &&
             has_shader_file(mode_file(methods.mode));
    default:
      return false;
  }
}

bool FrameCompositor::gives_reconstruction(const FrameInputs& inputs, Stage last) {
  return inputs.wants_reconstruction || last != Stage::finish;
}

bool FrameCompositor::gives_picture(const FrameInputs& inputs, Stage last) {
  return !inputs.texture || last != Stage::finish;
}

std::size_t FrameCompositor::most_added_bytes(const Rig& rig) {
  return pixels_of(rig.color.bounds()) * sizeof(std::uint32_t) +
         BackgroundPlanes::most_planes * cells_of_a_shadow * sizeof(Light) +
         sizeof(CompositionBlock) + 3 * block_alignment;
}

FrameCompositor::FrameCompositor(const Rig& rig)
    : label_(composition_pass({"rays.glsl", "label.comp"})),
      light_(composition_pass({"rays.glsl", "light.comp"})),
      sort_(composition_pass({"sort.comp"})),
      membrane_sums_(
          composition_pass({"membrane_nodes.glsl", "color_map.glsl", "membrane_sums.comp"})),
      membrane_solve_(composition_pass({"membrane_nodes.glsl", "membrane_solve.comp"})),
      map_colors_(composition_pass({"membrane_nodes.glsl", "color_map.glsl", "map_colors.comp"})),
      mix_second_(composition_pass({"membrane_nodes.glsl", "color_map.glsl", "map_colors.comp"},
                                   "#define SECOND_VIEW\n")),
      lift_(composition_pass({"lift.comp"})),
      smooth_guide_(composition_pass({"smoothing.glsl", "smooth_guide.comp"})),
      smooth_colors_(composition_pass({"smoothing.glsl", "smooth_colors.comp"})),
      row_distances_(composition_pass({"row_distances.comp"})),
      restore_(composition_pass({"restore.comp"})),
      rim_(composition_pass({"rim.comp"})) {
  const Rect whole = rig.color.bounds();
  for (Buffer* buffer : {&picture_, &values_, &state_, &surface_, &distances_}) {
    buffer->reserve(pixels_of(whole) * sizeof(std::uint32_t));
  }
  constexpr int cell = SoftMembrane::cell;
  const Rect nodes{0, 0, whole.width / cell + 2, whole.height / cell + 2};
  nodes_.reserve(2 * pixels_of(nodes) * 4 * sizeof(float));
  counts_.reserve(sizeof(FrameDownload::Counts));
  download_.reserve(whole, rig.rgbd.size() > 1);

  const RayGrid rays(rig.color);
  block_.ray_columns = rays.nodes().width();
  const std::size_t bytes = rays.nodes().size() * sizeof(Eigen::Vector2f);
  MappedBuffer staging(MappedBuffer::Use::upload);
  staging.reserve(bytes);
  std::memcpy(staging.data(), rays.nodes().data()->data(), bytes);
  ray_nodes_.reserve(bytes);
  ray_texture_.create(ray_nodes_, GL_RG32F, rays.nodes().size());
  copy(staging.name(), ray_nodes_.name(), bytes);
  wait_until_done();
}

void FrameCompositor::pack(const FrameInputs& inputs, Stage last, FrameUpload& upload) {
  last_ = last;
  const Options& options = inputs.options;
  region_ = static_cast<const Rect&>(inputs.region);
  std::size_t begin = 0;
  std::byte* const picture = upload.add(pixels_of(region_) * sizeof(std::uint32_t), begin);
  block_.camera_at = static_cast<std::uint32_t>(begin / 4);
  pack_picture(inputs.frame.color, inputs.masks.color, region_, picture);

  block_.plane_count = 0;
  for (std::size_t k = 0; inputs.planes && k < inputs.planes->size(); ++k) {
    block_.planes[block_.plane_count++] = PlaneBlock((*inputs.planes)[k]);
  }
  constexpr std::size_t light_bytes = cells_of_a_shadow * sizeof(Light);
  std::byte* const light = upload.add(inputs.shadows.size() * light_bytes, begin);
  block_.light_at = static_cast<std::uint32_t>(begin / 4);
  block_.shadow_count = 0;
  for (const CastShadow& shadow : inputs.shadows) {
    std::memcpy(light + block_.shadow_count * light_bytes, shadow.light.data()->data(),
                light_bytes);
    block_.shadows[block_.shadow_count++] = ShadowBlock(shadow);
  }

  using ColorRule = ColorCorrector::Declaration::Rule;
  const ColorCorrector::Declaration& color = inputs.methods.color;
  block_.mixes_second = color.maps != ColorMapModel::none && upload.blends() ? 1 : 0;
  const bool has_membrane = color.rule == ColorRule::maps_and_membrane;
  block_.node_columns = has_membrane ? region_.width / SoftMembrane::cell + 2 : 0;
  block_.node_rows = has_membrane ? region_.height / SoftMembrane::cell + 2 : 0;
  for (int k = 0; k < upload.cameras(); ++k) {
    const std::uint32_t source = upload.camera(k).source;
    block_.maps[k] = ColorMapBlock(inputs.color_maps[source], source);
  }

  using FillingRule = Inpainter::Declaration::Rule;
  const bool to_the_end = last == Stage::finish;
  const bool leaves_unknown =
      to_the_end && inputs.methods.inpainting.rule == FillingRule::leaves_unknown;
  block_.missing_code = leaves_unknown ? provenance::unknown : provenance::inpainted;
  const int rim_px = to_the_end ? soft_rim_width_px(options, !inputs.shadows.empty()) : 0;
  block_.rim_px = static_cast<std::uint32_t>(rim_px);
  block_.opacity = static_cast<float>(1 - options.transparency);
  std::byte* const block = upload.add(sizeof(block_), block_begin_);
  std::memcpy(block, &block_, sizeof(block_));
}

/// Frame, blocks and buffers, as composition.glsl names them.
void FrameCompositor::bind(const FrameUpload& upload, const ResultBuffers& reconstruction) const {
  upload.bind();
  upload.bind_block(2, block_begin_, sizeof(block_));
  const Buffer* const buffers[] = {&picture_, &state_, &surface_, &distances_, &counts_, &nodes_};
  for (GLuint i = 0; i < std::size(buffers); ++i) buffers[i]->bind(i);
  reconstruction.second.bind(6);
  reconstruction.first.bind(7);
  ray_texture_.bind(6);
}

void FrameCompositor::run_pass(const Program& program) const {
  program.use();
  glDispatchCompute(static_cast<GLuint>((region_.width + 63) / 64),
                    static_cast<GLuint>(region_.height), 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FrameCompositor::run(const FrameInputs& inputs, const FrameUpload& upload,
                          const ResultBuffers& reconstruction, PassTimer& timer) {
  bind(upload, reconstruction);
  timer.measure("label", [&] { run_pass(label_); });
  if (!inputs.shadows.empty()) timer.measure("light", [&] { run_pass(light_); });
  timer.measure("sort", [&] {
    const GLuint zero = 0;
    glClearNamedBufferData(counts_.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
    run_pass(sort_);
  });
  correct_colors(timer);
  if (!inputs.shadows.empty()) timer.measure("lift", [&] { run_pass(lift_); });
  const bool to_the_end = last_ == Stage::finish;
  if (to_the_end) finish(inputs, upload, reconstruction, timer);
  const Program& show_mode = show(to_the_end ? mode_file(inputs.methods.mode) : plain_mode);
  timer.measure("show", [&] { run_pass(show_mode); });
  timer.measure("download", [&] {
    download_.begin({picture_, counts_, surface_, reconstruction}, region_,
                    {gives_picture(inputs, last_), gives_reconstruction(inputs, last_)}, upload);
  });
}

void FrameCompositor::correct_colors(PassTimer& timer) const {
  const int nodes = block_.node_columns * block_.node_rows;
  if (nodes > 0) {
    timer.measure("membrane", [&] {
      membrane_sums_.use();
      glDispatchCompute(static_cast<GLuint>((nodes + 63) / 64), 1, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
      membrane_solve_.use();
      glDispatchCompute(1, 1, 1);
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    });
  }
  timer.measure("map", [&] { run_pass(map_colors_); });
  if (block_.mixes_second != 0) timer.measure("mix", [&] { run_pass(mix_second_); });
}

/// What comes after the pixels that cameras see.
void FrameCompositor::finish(const FrameInputs& inputs, const FrameUpload& upload,
                             const ResultBuffers& reconstruction, PassTimer& timer) {
  if (inputs.methods.inpainting.rule == Inpainter::Declaration::Rule::by_surface) {
    const Rect window = intersect(grow(inputs.objects, 1), region_);
    filling_.fill({picture_, state_, surface_}, region_, region_, window, timer);
    bind(upload, reconstruction);
  }
  if (inputs.options.smooth_colors && inputs.smoothing_share > 0) {
    timer.measure("smooth", [&] {
      values_.bind(5);  // the membrane is done
      run_pass(smooth_guide_);
      smooth_colors_.set("share", inputs.smoothing_share);
      run_pass(smooth_colors_);
    });
  }
  if (!inputs.shadows.empty() && !inputs.options.remove_shadows) {
    timer.measure("restore", [&] {
      run_pass(row_distances_);
      run_pass(restore_);
    });
  }
  if (block_.rim_px > 0) {
    timer.measure("rim", [&] {
      for (int erosion = 0; erosion < static_cast<int>(block_.rim_px); ++erosion) {
        rim_.set("erosion", erosion);
        run_pass(rim_);
      }
    });
  }
}

const Program& FrameCompositor::show(const std::string& file) {
  const auto found = shows_.find(file);
  if (found != shows_.end()) return found->second;
  return shows_.emplace(file, composition_pass({file, "show.comp"})).first->second;
}

}  // namespace diminish::gl
