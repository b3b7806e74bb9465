#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// The connected parts of a picture that are darker than what is around them.
class DarkComponents {
 public:
  /// Pixels [first, last) of row y.
  struct Run {
    int y, first, last;
    int component;
    int next;  ///< the component's next run, further down or to the right; -1: none
  };
  struct Component {
    Rect box;
    int first_run;
    int pixels;
  };

  /// A pixel is dark if it is 7 % (and two levels) below the mean of the 5x5 pixels around it.
  /// Parts are 4-connected: a marker's corner often touches that of the shadow around its margin.
  void find(const Image<std::uint8_t>& small);

  const std::vector<Component>& components() const { return components_; }
  const Run& run(int index) const { return runs_[static_cast<std::size_t>(index)]; }

 private:
  void threshold(const Image<std::uint8_t>& small);
  void collect_runs(int y, int width);
  void connect();
  int root(int run);

  std::vector<std::uint16_t> column_sums_;
  std::vector<std::uint8_t> dark_;
  std::vector<Run> runs_;
  std::vector<int> row_begin_, last_run_;
  std::vector<Component> components_;
};

}  // namespace diminish
