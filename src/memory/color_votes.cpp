#include "memory/color_votes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "memory/color_votes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// No fused multiply-add, and sums by column first: every CPU computes the same bits.
void CountVotes(const VoteSamples& samples, const Voter& voter, SideVotes& votes) {
  constexpr int side = VoteSamples::side;
  const hn::CappedTag<float, side> d;
  const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const auto one = set(1);
  const auto per_square = set(1.F / 300);  // of levels
  const auto least = set(0.9F * voter.far);
  const auto most = set(1.1F * voter.near);
  const auto middle = set((voter.near + voter.far) / 2);
  HWY_ALIGN float sums[4][side];
  for (int column = 0; column < side; column += static_cast<int>(hn::Lanes(d))) {
    auto far_weight = hn::Zero(d);
    auto near_weight = hn::Zero(d);
    auto far_sum = hn::Zero(d);
    auto near_sum = hn::Zero(d);
    for (int row = 0; row < side; ++row) {
      const VoteSamples own = samples.from(row * samples.pitch + column);
      const auto inverse_z = hn::LoadU(d, own.inverse_z);
      const auto blue = hn::Sub(hn::LoadU(d, own.blue), set(voter.blue));
      const auto green = hn::Sub(hn::LoadU(d, own.green), set(voter.green));
      const auto red = hn::Sub(hn::LoadU(d, own.red), set(voter.red));
      const auto squared =
          hn::Add(hn::Add(hn::Mul(blue, blue), hn::Mul(green, green)), hn::Mul(red, red));
      const auto likeness = hn::Div(one, hn::Add(one, hn::Mul(squared, per_square)));
      const auto votes_here = hn::And(hn::Ge(inverse_z, least), hn::Le(inverse_z, most));
      const auto weight = hn::IfThenElseZero(votes_here, hn::Mul(likeness, likeness));
      const auto weighted = hn::Mul(weight, inverse_z);
      const auto is_near = hn::Gt(inverse_z, middle);
      near_weight = hn::Add(near_weight, hn::IfThenElseZero(is_near, weight));
      near_sum = hn::Add(near_sum, hn::IfThenElseZero(is_near, weighted));
      far_weight = hn::Add(far_weight, hn::IfThenZeroElse(is_near, weight));
      far_sum = hn::Add(far_sum, hn::IfThenZeroElse(is_near, weighted));
    }
    hn::StoreU(far_weight, d, sums[0] + column);
    hn::StoreU(near_weight, d, sums[1] + column);
    hn::StoreU(far_sum, d, sums[2] + column);
    hn::StoreU(near_sum, d, sums[3] + column);
  }
  float totals[4] = {};
  for (int column = 0; column < side; ++column) {
    for (int i = 0; i < 4; ++i) totals[i] += sums[i][column];
  }
  votes = {{totals[0], totals[1]}, {totals[2], totals[3]}};
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {

HWY_EXPORT(CountVotes);

SideVotes count_votes(const VoteSamples& samples, const Voter& voter) {
  SideVotes votes;
  HWY_DYNAMIC_DISPATCH(CountVotes)(samples, voter, votes);
  return votes;
}

}  // namespace diminish
#endif
