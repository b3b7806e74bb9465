#include "gl/mask_drawer.h"

#include <algorithm>

#include "gl/buffer.h"
#include "gl/frame_block.h"
#include "gl/mask_bits.h"
#include "gl/program.h"

namespace diminish::gl {
namespace {

/// Half a row of the disc reaches at most into the next word.
constexpr int most_margin_px = 31;
constexpr int rows_of_part = 32;
constexpr std::size_t parts_across = 32768;

// As declared in masks.glsl.

/// A window of an image's mask, and where it begins in the arrays.
struct ImageBlock {
  BitWindow window;
  std::int32_t width, margin_px;  ///< of the whole image
  std::uint32_t first_word, padding;
};
static_assert(sizeof(ImageBlock) == 32);

/// Rows of a polygon.
struct PartBlock {
  std::uint32_t begin, end;  ///< of its corners
  std::int32_t first_row;
  std::uint32_t place;  ///< in `covers`: an image's objects, then the next image's
};
static_assert(sizeof(PartBlock) == 16);

/// A range of bytes that shaders see as a block.
struct Range {
  std::size_t begin = 0, bytes = 0;

  /// The range after `last`.
  static Range after(const Range& last, std::size_t bytes) {
    const std::size_t end = last.begin + last.bytes;
    return {(end + block_alignment - 1) / block_alignment * block_alignment, bytes};
  }
};

void bind(GLuint binding, GLuint buffer, const Range& range) {
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer, static_cast<GLintptr>(range.begin),
                    static_cast<GLsizeiptr>(std::max<std::size_t>(range.bytes, 4)));
}

/// Outlines grow and shrink from frame to frame. If there is not enough room, takes half as much
/// more.
std::size_t room_for(std::size_t bytes, std::size_t& room) {
  if (bytes > room) room = bytes + bytes / 2;
  return room;
}

void clear(GLuint buffer, const Range& range) {
  const GLuint zero = 0;
  glClearNamedBufferSubData(buffer, GL_R32UI, static_cast<GLintptr>(range.begin),
                            static_cast<GLsizeiptr>(range.bytes), GL_RED_INTEGER, GL_UNSIGNED_INT,
                            &zero);
}

}  // namespace

struct GpuMaskDrawer::Resources {
  Program fill = compute_program({"masks.glsl", "mask_fill.comp"});
  Program grow = compute_program({"masks.glsl", "mask_grow.comp"});
  Buffer input, drawn, output;
  MappedBuffer uploaded{MappedBuffer::Use::upload};
  MappedBuffer downloaded{MappedBuffer::Use::download};

  std::vector<ImageBlock> images;
  std::vector<PartBlock> parts;
  std::size_t words = 0, corners = 0, objects = 0, most_words = 0;
  bool is_blank = true;

  void list(std::span<const MaskDrawing> drawings);
  void upload(std::span<const MaskDrawing> drawings);
  void run() const;
  void read(std::span<MaskDrawing> drawings) const;

 private:
  void list_parts(const MaskDrawing& drawing, std::size_t image);

  Range image_range_, part_range_, corner_range_, bit_range_;         ///< of the input
  Range grown_range_, cover_range_;                                   ///< of the output
  std::size_t input_bytes_ = 0, drawn_bytes_ = 0, output_bytes_ = 0;  ///< for which there is room
};

void GpuMaskDrawer::Resources::list(std::span<const MaskDrawing> drawings) {
  images.clear();
  parts.clear();
  words = corners = most_words = 0;
  is_blank = true;
  objects = drawings.empty() ? 0 : drawings[0].covers.size();
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const MaskDrawing& drawing = drawings[i];
    const int margin_px = drawing.margin_px <= most_margin_px ? drawing.margin_px : 0;
    const BitWindow window(
        intersect(diminish::grow(drawing.part, margin_px), drawing.mask->bounds()));
    const auto image_words = static_cast<std::size_t>(window.size());
    images.push_back(
        {window, drawing.mask->width(), margin_px, static_cast<std::uint32_t>(words), 0});
    list_parts(drawing, i);
    words += image_words;
    most_words = std::max(most_words, image_words);
    corners += drawing.polygons->corners.size();
    is_blank = is_blank && drawing.is_blank;
  }
}

void GpuMaskDrawer::Resources::list_parts(const MaskDrawing& drawing, std::size_t image) {
  const Polygons& all = *drawing.polygons;
  for (std::size_t p = 0; p < all.polygons.size(); ++p) {
    const PolygonRows rows(all, p, drawing.mask->height());
    for (int row = rows.first; row < rows.last; row += rows_of_part) {
      parts.push_back({static_cast<std::uint32_t>(corners + all.begin_of(p)),
                       static_cast<std::uint32_t>(corners + all.polygons[p].end), row,
                       static_cast<std::uint32_t>(image * objects + all.polygons[p].object)});
    }
  }
}

void GpuMaskDrawer::Resources::upload(std::span<const MaskDrawing> drawings) {
  image_range_ = {0, images.size() * sizeof(ImageBlock)};
  part_range_ = Range::after(image_range_, parts.size() * sizeof(PartBlock));
  corner_range_ = Range::after(part_range_, corners * sizeof(Polygons::Corner));
  bit_range_ = Range::after(corner_range_, is_blank ? 0 : words * sizeof(std::uint32_t));
  const std::size_t bytes = bit_range_.begin + std::max<std::size_t>(bit_range_.bytes, 4);
  grown_range_ = {0, words * sizeof(std::uint32_t)};
  cover_range_ = Range::after(grown_range_, images.size() * objects * sizeof(std::uint32_t));
  const std::size_t output_bytes =
      cover_range_.begin + std::max<std::size_t>(cover_range_.bytes, 4);
  input.reserve(room_for(bytes, input_bytes_));
  uploaded.reserve(input_bytes_);
  drawn.reserve(room_for(grown_range_.bytes, drawn_bytes_));
  output.reserve(room_for(output_bytes, output_bytes_));
  downloaded.reserve(output_bytes_);

  std::byte* const to = uploaded.data();
  std::copy(images.begin(), images.end(), reinterpret_cast<ImageBlock*>(to));
  std::copy(parts.begin(), parts.end(), reinterpret_cast<PartBlock*>(to + part_range_.begin));
  auto* corner = reinterpret_cast<Polygons::Corner*>(to + corner_range_.begin);
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const std::vector<Polygons::Corner>& of_image = drawings[i].polygons->corners;
    corner = std::copy(of_image.begin(), of_image.end(), corner);
    if (is_blank) continue;
    auto* const bits = reinterpret_cast<std::uint32_t*>(to + bit_range_.begin);
    pack_bits(*drawings[i].mask, images[i].window, bits + images[i].first_word);
  }
  copy(uploaded.name(), input.name(), bytes);
}

void GpuMaskDrawer::Resources::run() const {
  if (is_blank) {
    clear(drawn.name(), grown_range_);
  } else {
    glCopyNamedBufferSubData(input.name(), drawn.name(), static_cast<GLintptr>(bit_range_.begin), 0,
                             static_cast<GLsizeiptr>(bit_range_.bytes));
  }
  clear(output.name(), cover_range_);
  bind(0, input.name(), image_range_);
  bind(1, input.name(), part_range_);
  bind(2, input.name(), corner_range_);
  drawn.bind(3);
  bind(4, output.name(), grown_range_);
  bind(5, output.name(), cover_range_);
  if (!parts.empty()) {
    fill.use();
    glProgramUniform2ui(fill.name(), 0, static_cast<GLuint>(parts.size()),
                        static_cast<GLuint>(objects));
    const std::size_t across = std::min(parts.size(), parts_across);
    glDispatchCompute(static_cast<GLuint>(across),
                      static_cast<GLuint>((parts.size() + across - 1) / across), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
  grow.use();
  glDispatchCompute(static_cast<GLuint>((most_words + 63) / 64), static_cast<GLuint>(images.size()),
                    1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  copy(output.name(), downloaded.name(), cover_range_.begin + cover_range_.bytes);
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
}

void GpuMaskDrawer::Resources::read(std::span<MaskDrawing> drawings) const {
  const auto* const grown = reinterpret_cast<const std::uint32_t*>(downloaded.data());
  const auto* covers =
      reinterpret_cast<const std::uint32_t*>(downloaded.data() + cover_range_.begin);
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    unpack_bits(grown + images[i].first_word, images[i].window, *drawings[i].mask);
    for (std::uint8_t& covered : drawings[i].covers) covered = *covers++ != 0 ? 1 : covered;
  }
}

GpuMaskDrawer::GpuMaskDrawer() {
  context_.run([&] {
    resources_ = std::make_unique<Resources>();
    context_.check("making the programs that draw masks");
  });
}

GpuMaskDrawer::~GpuMaskDrawer() {
  context_.run([&] { resources_.reset(); });
}

void GpuMaskDrawer::draw(std::span<MaskDrawing> drawings) {
  resources_->list(drawings);
  if (resources_->words > 0) {
    context_.run([&] {
      resources_->upload(drawings);
      resources_->run();
      wait_until_done();
      context_.check("drawing masks");
    });
  }
  if (resources_->words > 0) resources_->read(drawings);
  for (const MaskDrawing& drawing : drawings) {
    if (drawing.margin_px > most_margin_px)
      dilation_.dilate(*drawing.mask, drawing.part, drawing.margin_px);
  }
}

namespace {

const bool mask_drawer_registered =
    Registry<MaskDrawer>::add("gl", [] { return std::make_unique<GpuMaskDrawer>(); });

}  // namespace
}  // namespace diminish::gl
