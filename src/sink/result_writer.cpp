#include "sink/result_writer.h"

#include <array>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/indexed_png.h"
#include "sink/palette.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

constexpr std::array picture_folders = {"result", "mask", "reconstruction", "provenance"};
constexpr const char* preview_folder = "preview";
constexpr std::array files = {"frames.csv", "summary.json", "result.mp4", "score.json"};

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(Error::io, folder.string() + ": cannot be made: " + error.message());
}

void remove_pictures(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".png") fs::remove(entry.path(), ignored);
  }
}

}  // namespace

ResultWriter::ResultWriter(fs::path folder, const Rig& rig, const Options& options,
                           double frames_per_second, const ResultWriterOptions& writer_options)
    : folder_(std::move(folder)), options_(options), preview_only_(writer_options.preview_only) {
  prepare_folder(writer_options.force);
  csv_.emplace(folder_ / "frames.csv", rig);
  if (!preview_only_) video_.emplace(folder_ / "result.mp4", frames_per_second);
}

void ResultWriter::prepare_folder(bool force) const {
  std::error_code error;
  const bool exists = fs::exists(folder_, error);
  if (exists && !fs::is_directory(folder_, error)) {
    throw Error(Error::io, folder_.string() + ": expected a folder for the results, got a file");
  }
  if (exists && !fs::is_empty(folder_, error)) {
    if (!force) {
      throw Error(Error::io, folder_.string() + ": not empty; --force replaces the results in it");
    }
    for (const char* name : picture_folders) remove_pictures(folder_ / name);
    remove_pictures(folder_ / preview_folder);
    remove_pictures(folder_ / "score");
    for (const char* name : files) fs::remove(folder_ / name, error);
  }
  make_folder(folder_);
  if (preview_only_) {
    make_folder(folder_ / preview_folder);
  } else {
    for (const char* name : picture_folders) make_folder(folder_ / name);
  }
}

void ResultWriter::write_images(const FrameSet& frame, const DiminishedFrame& result) {
  const std::string name = result.name + ".png";
  if (preview_only_) {
    cv::Mat side_by_side;
    cv::hconcat(as_mat(frame.color), as_mat(result.picture), side_by_side);
    write_png(folder_ / preview_folder / name, side_by_side);
    return;
  }
  write_png(folder_ / "result" / name, as_mat(result.picture));
  write_png(folder_ / "mask" / name, as_mat(result.mask));
  write_png(folder_ / "reconstruction" / name, as_mat(result.reconstruction.color));
  PartialFile partial(folder_ / "provenance" / name);
  write_indexed_png(partial.path(), result.provenance, provenance_palette());
  partial.commit();
}

void ResultWriter::append(const FrameSet&, const DiminishedFrame& result) {
  csv_->append(result);
  statistics_.add(result.report);
  if (video_ && !result.report.skipped) video_->append(result.picture);
}

std::string ResultWriter::finish(bool interrupted) {
  const std::string video_problem = video_ ? video_->finish() : "";
  write_summary(interrupted, video_problem);
  return video_problem;
}

void ResultWriter::write_summary(bool interrupted, const std::string& video_problem) const {
  nlohmann::ordered_json summary;
  summary["version"] = DIMINISH_VERSION;
  summary["complete"] = !interrupted;
  summary["frames"] = statistics_.frames();
  summary["skipped"] = statistics_.skipped();
  summary["faulty"] = statistics_.faulty();
  summary["pixels"] = {{"mask", statistics_.mask_pixels()},
                       {"valid", statistics_.valid_pixels()},
                       {"missing", statistics_.missing_pixels()}};
  for (std::size_t row = 0; row < time_row_count; ++row) {
    const RunStatistics::Times& times = statistics_.times()[row];
    summary["milliseconds"][time_rows()[row].key] = {
        {"avg", statistics_.average_ms(row)}, {"min", times.min_ms}, {"max", times.max_ms}};
  }
  summary["messages"] = statistics_.messages();
  if (!video_problem.empty()) summary["video"] = video_problem;
  for_each_option(options_, [&](const OptionInfo& info, const auto& value) {
    summary["options"][info.name] = value;
  });
  // File names in messages may not be UTF-8.
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  write_file(folder_ / "summary.json", summary.dump(2, ' ', false, replace) + "\n");
}

}  // namespace diminish
