#pragma once

#include <memory>
#include <optional>

#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/gl_texture.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scan.h"
#include "diminish/scene.h"

namespace diminish {

/// The whole frame: a FrameSet in, a DiminishedFrame out. With the option `memory`, what the colour
/// camera has seen in earlier frames is used; else nothing of a frame influences the next. One
/// object may be used by one thread at a time.
///
/// `process` runs on as many threads as the oneTBB arena that it is called in allows
/// (oneapi::tbb::task_arena): the caller's, and helpers, which all pipelines of a process share.
/// Outside any arena that is one for each core, within the process's oneapi::tbb::global_control.
/// The result does not depend on it.
/// What a frame uses of OpenCV runs in the calling thread.
class DIMINISH_EXPORT Pipeline {
 public:
  /// Throws Error on configurations that cannot work.
  Pipeline(const Rig& rig, const Scene& scene, const Options& options);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Takes effect with the next frame. Throws Error on values out of range.
  void set_options(const Options& options);
  const Options& options() const;

  /// Whether markers are looked for, in all cameras' images.
  bool needs_markers() const;

  /// Whether the caller needs `result.reconstruction`; by default it does. If not, only those of
  /// its colours are filled that the frame needs; and where a GPU makes the whole frame, its images
  /// stay there and are empty in the result.
  void want_reconstruction(bool wanted);

  /// From the next frame on, puts each picture into a texture that the application shares; nullopt:
  /// no longer. Where a GPU makes the whole frame, `result.picture` and `result.provenance` are
  /// then empty: only the report is read back. Where the CPU makes the picture, it is uploaded, and
  /// a message says so. Throws Error if diminish was built without OpenGL or the context cannot be
  /// shared. Call it again if the application's context was lost.
  void want_texture(const std::optional<GlSharing>& application);
  /// The last frame's picture. It has no name if the frame was skipped, no texture is wanted, or
  /// the GPU failed; a message says so, and `result.picture` is filled.
  const GlTexture& texture() const;

  /// Shares what `other` remembers: both work on frames of one sequence. Call it before the first
  /// frame. Then, for each frame and in the frames' order, call `take_turn`, and after it, from any
  /// thread, `process` or `pass_turn`: a frame waits for what the frames before it have learnt.
  void share_memory(Pipeline& other);
  void take_turn();
  /// For a frame that will not be processed.
  void pass_turn();
  /// Forgets all that was seen before the next frame, the background too.
  void forget();

  /// Fills the memory with what was seen of the place before. Call it before the first frame.
  /// Throws Error if the scan is of another colour camera, or its world is not the one that the
  /// rig's poses are in.
  void set_background(const Scan& scan);
  /// What is remembered after the frames so far, without objects to remove. Throws Error if the
  /// rig's poses are not in a world that another recording can share.
  Scan scan();

  /// `result`'s memory is used again. Never throws for what a camera delivered: that is reported.
  void process(const FrameSet& frame, DiminishedFrame& result);
  /// The stage that `process` began last; nothing outside it. May be called at any time, from any
  /// thread: for a watchdog.
  std::optional<Stage> stage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
