#pragma once

namespace diminish {

// Without branches, so that compilers turn loops over pixels into vectors.

/// Whether all conditions hold.
template <class... Bools>
constexpr bool all_of(Bools... conditions) {
  return (int{conditions} & ...) != 0;
}

/// Whether any condition holds.
template <class... Bools>
constexpr bool any_of(Bools... conditions) {
  return (int{conditions} | ...) != 0;
}

}  // namespace diminish
