#include "diminish/result_writer.h"

#include <array>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <system_error>
#include <utility>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/frames_csv.h"
#include "sink/indexed_png.h"
#include "sink/palette.h"
#include "sink/partial_file.h"
#include "sink/run_statistics.h"
#include "sink/video_file.h"

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

struct ResultWriter::Implementation {
  void prepare_folder(bool force) const;
  void write_summary(bool interrupted, const std::string& video_problem) const;

  fs::path folder;
  Options options;
  bool preview_only = false;
  std::optional<FramesCsv> csv;
  std::optional<VideoFile> video;
  RunStatistics statistics;
};

ResultWriter::ResultWriter(fs::path folder, const Rig& rig, const Options& options,
                           double frames_per_second, const ResultWriterOptions& writer_options)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.folder = std::move(folder);
  self.options = options;
  self.preview_only = writer_options.preview_only;
  self.prepare_folder(writer_options.force);
  self.csv.emplace(self.folder / "frames.csv", rig);
  if (!self.preview_only) self.video.emplace(self.folder / "result.mp4", frames_per_second);
}

ResultWriter::~ResultWriter() = default;

void ResultWriter::Implementation::prepare_folder(bool force) const {
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) {
    throw Error(Error::io, folder.string() + ": expected a folder for the results, got a file");
  }
  if (exists && !fs::is_empty(folder, error)) {
    if (!force) {
      throw Error(Error::io, folder.string() + ": not empty; --force replaces the results in it");
    }
    for (const char* name : picture_folders) remove_pictures(folder / name);
    remove_pictures(folder / preview_folder);
    remove_pictures(folder / "score");
    for (const char* name : files) fs::remove(folder / name, error);
  }
  make_folder(folder);
  if (preview_only) {
    make_folder(folder / preview_folder);
  } else {
    for (const char* name : picture_folders) make_folder(folder / name);
  }
}

void ResultWriter::write_images(const FrameSet& frame, const DiminishedFrame& result) {
  const Implementation& self = *implementation_;
  const std::string name = result.name + ".png";
  if (self.preview_only) {
    cv::Mat side_by_side;
    cv::hconcat(as_mat(frame.color), as_mat(result.picture), side_by_side);
    write_png(self.folder / preview_folder / name, side_by_side);
    return;
  }
  write_png(self.folder / "result" / name, as_mat(result.picture));
  write_png(self.folder / "mask" / name, as_mat(result.mask));
  write_png(self.folder / "reconstruction" / name, as_mat(result.reconstruction.color));
  write_indexed_png(self.folder / "provenance" / name, result.provenance, provenance_palette());
}

void ResultWriter::append(const FrameSet&, const DiminishedFrame& result) {
  Implementation& self = *implementation_;
  self.csv->append(result);
  self.statistics.add(result.report);
  if (self.video && !result.report.skipped) self.video->append(result.picture);
}

std::string ResultWriter::finish(bool interrupted) {
  Implementation& self = *implementation_;
  const std::string video_problem = self.video ? self.video->finish() : "";
  self.write_summary(interrupted, video_problem);
  return video_problem;
}

std::size_t ResultWriter::faulty_frames() const {
  return implementation_->statistics.faulty();
}

std::string ResultWriter::table() const {
  return implementation_->statistics.table();
}

void ResultWriter::Implementation::write_summary(bool interrupted,
                                                 const std::string& video_problem) const {
  nlohmann::ordered_json summary;
  summary["version"] = DIMINISH_VERSION;
  summary["complete"] = !interrupted;
  summary["frames"] = statistics.frames();
  summary["skipped"] = statistics.skipped();
  summary["faulty"] = statistics.faulty();
  summary["in_doubt"] = statistics.in_doubt();
  summary["pixels"] = {{"mask", statistics.mask_pixels()},
                       {"valid", statistics.valid_pixels()},
                       {"missing", statistics.missing_pixels()},
                       {"witnessed", statistics.witnessed_pixels()},
                       {"remembered", statistics.remembered_pixels()},
                       {"estimated", statistics.estimated_pixels()},
                       {"background", statistics.background_pixels()}};
  summary["evidence"] = to_text(statistics.shares(), 1);
  if (const auto ages = statistics.remembered_ages()) {
    summary["remembered_age_s"] = {{"median", ages->median_s}, {"oldest", ages->oldest_s}};
  }
  for (std::size_t row = 0; row < time_row_count; ++row) {
    const RunStatistics::Times& times = statistics.times()[row];
    summary["milliseconds"][time_rows()[row].key] = {
        {"avg", statistics.average_ms(row)}, {"min", times.min_ms}, {"max", times.max_ms}};
  }
  summary["messages"] = statistics.messages();
  if (!video_problem.empty()) summary["video"] = video_problem;
  for_each_option(options, [&](const OptionInfo& info, const auto& value) {
    summary["options"][info.name] = value;
  });
  // File names in messages may not be UTF-8.
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  write_file(folder / "summary.json", summary.dump(2, ' ', false, replace) + "\n");
}

}  // namespace diminish
