#include "camera/sender_clock.h"

#include <algorithm>
#include <chrono>

namespace diminish {
namespace {

/// An image that is no older than this, nor from the future, is stamped by a clock like ours.
constexpr double most_age_s = 0.2;
constexpr double most_ahead_s = 0.002;

}  // namespace

double utc_from_monotonic_s() {
  const auto utc = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(utc).count() - monotonic_now_s();
}

double SenderClock::local_s(double stamp_s, double arrival_s, double utc_from_monotonic_s) {
  estimate_.add(stamp_s, arrival_s);
  last_stamp_s_ = stamp_s;
  utc_from_monotonic_s_ = utc_from_monotonic_s;
  const double said_s = stamp_s - utc_from_monotonic_s;
  if (!is_trusted_) {
    const double age_s = arrival_s - said_s;
    is_trusted_ =
        kind_ == Ros2Address::Clock::synchronized ||
        (kind_ == Ros2Address::Clock::automatic && age_s >= -most_ahead_s && age_s <= most_age_s);
  }
  return std::min(arrival_s, stamp_s + offset_s());
}

double SenderClock::offset_s() const {
  if (!is_trusted_) return 0;
  return *is_trusted_ ? -utc_from_monotonic_s_ : estimate_.offset_s(last_stamp_s_);
}

std::optional<CameraClock> SenderClock::state() const {
  if (!is_trusted_) return std::nullopt;
  // The estimate is ours less theirs.
  return CameraClock{-estimate_.offset_s(last_stamp_s_) - utc_from_monotonic_s_, -estimate_.drift(),
                     *is_trusted_};
}

}  // namespace diminish
