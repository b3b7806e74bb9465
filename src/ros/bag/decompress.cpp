#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "diminish/error.h"
#include "ros/bag/records.h"

#ifdef DIMINISH_HAS_BZIP2
#include <bzlib.h>
#endif
#ifdef DIMINISH_HAS_LZ4
#include <lz4frame.h>
#endif
#ifdef DIMINISH_HAS_ZSTD
#include <zstd.h>
#endif

namespace diminish::ros {
namespace {

/// What claims to grow by more takes no memory: even an image of zeros does not.
constexpr std::size_t most_growth = 20'000;

/// A library that the build is without fails like this; so does one that finds fault.
[[noreturn, maybe_unused]] void fail_without(std::string_view method) {
  throw Error(
      fmt::format("a chunk is compressed by {}, which this build is without", printable(method)));
}

/// How many bytes there are now; nothing where the chunk is broken or longer.
std::size_t unpack_bz2([[maybe_unused]] std::span<const std::uint8_t> from,
                       [[maybe_unused]] std::span<std::uint8_t> to) {
#ifdef DIMINISH_HAS_BZIP2
  auto size = static_cast<unsigned>(to.size());
  // It takes what it only reads as non-const.
  auto* const source = reinterpret_cast<char*>(const_cast<std::uint8_t*>(from.data()));
  const int result = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to.data()), &size, source,
                                                static_cast<unsigned>(from.size()), 0, 0);
  return result == BZ_OK ? size : 0;
#else
  fail_without("bz2");
#endif
}

std::size_t unpack_lz4([[maybe_unused]] std::span<const std::uint8_t> from,
                       [[maybe_unused]] std::span<std::uint8_t> to) {
#ifdef DIMINISH_HAS_LZ4
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return 0;
  std::size_t done = 0;
  while (!from.empty()) {
    std::size_t taken = from.size();
    std::size_t made = to.size() - done;
    const std::size_t result =
        LZ4F_decompress(context, to.data() + done, &made, from.data(), &taken, nullptr);
    const bool is_stuck = LZ4F_isError(result) != 0 || (taken == 0 && made == 0);
    if (is_stuck) done = 0;
    if (is_stuck) break;
    from = from.subspan(taken);
    done += made;
  }
  LZ4F_freeDecompressionContext(context);
  return done;
#else
  fail_without("lz4");
#endif
}

std::size_t unpack_zstd([[maybe_unused]] std::span<const std::uint8_t> from,
                        [[maybe_unused]] std::span<std::uint8_t> to) {
#ifdef DIMINISH_HAS_ZSTD
  const std::size_t size = ZSTD_decompress(to.data(), to.size(), from.data(), from.size());
  return ZSTD_isError(size) == 0 ? size : 0;
#else
  fail_without("zstd");
#endif
}

}  // namespace

void decompress(std::string_view method, std::span<const std::uint8_t> from, std::uint64_t size,
                std::vector<std::uint8_t>& to) {
  const std::size_t most = std::min(most_record_bytes, most_growth * from.size());
  if (size > most) {
    throw Error(Error::input,
                fmt::format("expected a chunk of at most {} bytes, got {}", most, size));
  }
  to.resize(size);
  std::size_t done = 0;
  if (method == "bz2") {
    done = unpack_bz2(from, to);
  } else if (method == "lz4") {
    done = unpack_lz4(from, to);
  } else if (method == "zstd") {
    done = unpack_zstd(from, to);
  } else {
    throw Error(
        Error::input,
        fmt::format("expected chunks compressed by bz2, lz4 or zstd, got '{}'", printable(method)));
  }
  if (done != size) {
    throw Error(Error::input,
                fmt::format("a chunk is broken: expected {} bytes of {}", size, method));
  }
}

}  // namespace diminish::ros
