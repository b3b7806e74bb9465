#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

/// The membrane: a library of its own (CMake: diminish::membrane) that needs nothing else of
/// diminish.

namespace diminish {

class MembraneSolver;

/// Solves Laplace's equation on any set of pixels, to clone a part of one picture into another
/// without a seam, or to fill holes smoothly. A set may have any shape and any number of parts, and
/// may touch the picture's border.
///
/// Results are within about half a level of the exact solution, including rounding; parts that are
/// attached by only a few pixels may be further off. The cost of a large set follows its outline,
/// not its area. Memory is kept for the next call and does not grow for similar sets. Results do
/// not depend on earlier calls or the number of threads.
///
/// One object serves one thread at a time. Inside a call the work of large sets is shared
/// among as many threads as the caller's oneTBB arena allows.
class Membrane {
 public:
  /// A view of 8-bit pixels that belong to someone else: rows `stride` bytes apart (negative:
  /// bottom up), pixels `channels` bytes apart.
  template <class Byte>
  struct BasicView {
    Byte* data = nullptr;
    int width = 0, height = 0;  ///< pixels
    std::ptrdiff_t stride = 0;  ///< bytes
    int channels = 1;

    Byte* row(int y) const { return data + y * stride; }
    Byte* pixel(int x, int y) const { return row(y) + std::ptrdiff_t{x} * channels; }
    /// The pixels [x, x + part_width) of the rows [y, y + part_height).
    BasicView part(int x, int y, int part_width, int part_height) const {
      return {pixel(x, y), part_width, part_height, stride, channels};
    }
    template <class Other>
    requires std::is_same_v<Other, const Byte>
    operator BasicView<Other>() const { return {data, width, height, stride, channels}; }
  };
  using View = BasicView<std::uint8_t>;
  using ConstView = BasicView<const std::uint8_t>;

  Membrane();
  ~Membrane();
  Membrane(Membrane&&) noexcept;
  Membrane& operator=(Membrane&&) noexcept;

  /// What to clone. All views have the same size. Three channels in any order.
  struct Cloning {
    ConstView target;  ///< only read beside the mask; 3 or 4 channels
    ConstView source;  ///< 3 or 4 channels; a fourth is ignored
    ConstView mask;    ///< 1 channel; not 0: take the pixel from `source`
    /// 1 channel: 0 where `source` shows nothing, else the number, 1 to 254, of the picture that
    /// the pixel comes from (255 counts as 254). Jumps in colour between pictures are evened out.
    /// Without data: it is one picture that shows something everywhere.
    ConstView layers = {};
  };

  /// Poisson seamless cloning (Perez, Gangnet & Blake 2003). Writes to `picture`, where the mask is
  /// set and `source` shows something, colours with the gradient of `source` that join `target` at
  /// the mask's outline. Writes nothing else. picture: 3 channels; may be `target`.
  ///
  /// Colours are free beside pixels where `source` shows nothing and at the views' border. Parts of
  /// the mask without a pixel of `target` beside them where `source` shows something get the mean
  /// correction. Throws std::invalid_argument on views of other sizes or channels.
  void clone(const Cloning& cloning, View picture);

  /// Fills the pixels of `picture` where the mask is not 0 from those around them, with the
  /// smoothest filling (harmonic), which invents no edges. It is free at the picture's border.
  /// picture: 3 channels. mask: 1 channel, same size. Returns false and leaves the picture alone if
  /// there is no pixel to fill from. Throws std::invalid_argument on views of other sizes or
  /// channels.
  bool fill(ConstView mask, View picture);

 private:
  std::unique_ptr<MembraneSolver> solver_;
};

}  // namespace diminish
