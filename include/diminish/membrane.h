#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

/// \file
/// The membrane: a library of its own (CMake: diminish::membrane), which needs nothing else of
/// diminish.

namespace diminish {

class MembraneSolver;

/// Laplace's equation on any set of pixels, for two things that pictures need: to clone a part of
/// one picture into another without a seam, and to fill holes smoothly. A set may have any shape,
/// any number of parts, and touch the picture's border.
///
/// Results are about half a level from the exact solution, rounding included; where a part of the
/// set hangs on a few pixels it may be more. Large sets cost what their outline does, and not their
/// area. Memory is kept for the next call, and does not grow where sets are alike. Results do not
/// depend on earlier calls, nor on the number of threads.
///
/// One object serves one thread at a time; inside a call oneTBB shares the work of large sets
/// between two threads.
class Membrane {
 public:
  /// 8-bit pixels that belong to someone else: rows `stride` bytes apart (negative: bottom up),
  /// pixels `channels` bytes apart.
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

  /// What is cloned. All views have one size. Three channels, in whatever order.
  struct Cloning {
    ConstView target;  ///< read only beside the mask; 3 or 4 channels
    ConstView source;  ///< 3 or 4 channels; a fourth is not looked at
    ConstView mask;    ///< 1 channel; not 0: to be taken from `source`
    /// 1 channel: 0 where `source` shows nothing, else which of several pictures it was put
    /// together from, 1 to 254 (255 counts as 254): where colours jump from one to the next, that
    /// is evened out. Without data: it is one picture, and shows something everywhere.
    ConstView layers = {};
  };

  /// Poisson seamless cloning (Perez, Gangnet & Blake 2003): writes to `picture`, where the mask is
  /// set and `source` shows something, colours with the gradient of `source` which pass into
  /// `target` at the mask's outline; writes nothing else. picture: 3 channels; may be `target`.
  ///
  /// Beside pixels where `source` shows nothing, and at the views' border, colours are free. Parts
  /// of the mask with no pixel of `target` beside them where `source` shows something get the mean
  /// correction.
  /// Throws std::invalid_argument on views of other sizes or channels.
  void clone(const Cloning& cloning, View picture);

  /// Fills the pixels of `picture` where the mask is not 0 from those around them: the smoothest
  /// filling there is (harmonic), which invents no edges. At the picture's border it is free.
  /// picture: 3 channels. mask: 1 channel, of the same size.
  /// Returns false, and leaves the picture alone, if the mask leaves no pixel to fill from.
  /// Throws std::invalid_argument on views of other sizes or channels.
  bool fill(ConstView mask, View picture);

 private:
  std::unique_ptr<MembraneSolver> solver_;
};

}  // namespace diminish
