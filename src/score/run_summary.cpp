#include "score/run_summary.h"

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {

nlohmann::json read_run_summary(const std::filesystem::path& run) {
  constexpr std::size_t most_bytes = 1 << 24;
  const std::filesystem::path file = run / "summary.json";
  nlohmann::json summary = nlohmann::json::parse(read_text_file(file, most_bytes), nullptr, false);
  if (summary.is_discarded()) throw Error(Error::input, file.string() + ": is not JSON");
  return summary;
}

}  // namespace diminish
