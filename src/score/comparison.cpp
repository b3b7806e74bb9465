#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "diminish/error.h"
#include "diminish/report.h"
#include "diminish/score.h"
#include "score/html.h"
#include "score/run_folder.h"
#include "score/run_summary.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

struct Figure {
  const char* title;
  std::optional<double> (*of)(const Score& score);
};

template <auto part>
std::optional<double> psnr_of(const Score& score) {
  const std::optional<Quality>& quality = score.mean.*part;
  return quality ? std::optional(quality->psnr_db) : std::nullopt;
}
/// origin: index in score_origins.
template <std::size_t origin>
std::optional<double> psnr_of_origin(const Score& score) {
  const auto& found = score.mean.origins[origin];
  return found ? std::optional(found->quality.psnr_db) : std::nullopt;
}
template <auto figure>
std::optional<double> viewer_figure(const Score& score) {
  return score.mean.viewer ? std::optional<double>((*score.mean.viewer).*figure) : std::nullopt;
}

constexpr Figure figures[] = {
    {"PSNR inside, dB", psnr_of<&FrameScore::inside>},
    {"SSIM inside",
     [](const Score& score) {
       return score.mean.inside ? std::optional(score.mean.inside->ssim) : std::nullopt;
     }},
    {"PSNR of seen pixels, dB", psnr_of_origin<0>},
    {"PSNR of witnessed pixels, dB", psnr_of_origin<1>},
    {"PSNR of remembered pixels, dB", psnr_of_origin<2>},
    {"PSNR of invented pixels, dB", psnr_of_origin<4>},
    {"invented, share", viewer_figure<&ViewerFigures::invented_share>},
    {"edges, recall", viewer_figure<&ViewerFigures::edge_recall>},
    {"edges, precision", viewer_figure<&ViewerFigures::edge_precision>},
    {"edges, F1", viewer_figure<&ViewerFigures::edge_f1>},
    {"gradients alike", viewer_figure<&ViewerFigures::gradient_similarity>},
    {"sharpness of seen pixels",
     [](const Score& score) {
       return score.mean.viewer ? score.mean.viewer->sharpness_seen : std::nullopt;
     }},
    {"sharpness of invented pixels",
     [](const Score& score) {
       return score.mean.viewer ? score.mean.viewer->sharpness_invented : std::nullopt;
     }},
    {"flicker, grey levels", [](const Score& score) { return score.flicker; }},
};

std::string figures_table(const Score& first, const Score& second) {
  std::string text = "<table><tr><th><th>first<th>second<th>difference</tr>\n";
  for (const Figure& figure : figures) {
    const auto a = figure.of(first);
    const auto b = figure.of(second);
    if (!a && !b) continue;
    const auto cell = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.3f}", *value) : std::string();
    };
    text += fmt::format("<tr><td>{}<td>{}<td>{}<td>{}</tr>\n", figure.title, cell(a), cell(b),
                        a && b ? fmt::format("{:+.3f}", *b - *a) : std::string());
  }
  return text + "</table>\n";
}

std::string options_table(const nlohmann::json& first, const nlohmann::json& second) {
  std::string rows;
  const nlohmann::json none = nlohmann::json::object();
  const nlohmann::json& a = first.value("options", none);
  const nlohmann::json& b = second.value("options", none);
  for (const auto& [name, value] : a.items()) {
    if (!b.contains(name) || b[name] == value) continue;
    rows += fmt::format("<tr><td>{}<td>{}<td>{}</tr>\n", html::escaped(name),
                        html::escaped(value.dump()), html::escaped(b[name].dump()));
  }
  if (rows.empty()) return "<p>Both have the same options.</p>\n";
  return "<table><tr><th>option<th>first<th>second</tr>\n" + rows + "</table>\n";
}

/// A frame of both runs, around the object.
struct Pair {
  std::string name;
  std::optional<Quality> first_quality, second_quality;
  cv::Mat input, truth, first, second;
  double difference = 0;  ///< mean over pixels and channels, levels
};

/// Nothing where a picture is missing.
std::optional<Pair> find_pair(const RunFolder& first, const RunFolder& second,
                              const std::string& name) {
  cv::Mat input = first.input(name);
  cv::Mat truth = first.truth(name);
  cv::Mat a = first.result(name);
  cv::Mat b = second.result(name);
  cv::Mat mask = first.mask(name);
  const cv::Mat other_mask = second.mask(name);
  const cv::Size size = a.size();
  for (const cv::Mat* image :
       std::initializer_list<const cv::Mat*>{&input, &truth, &b, &mask, &other_mask}) {
    if (image->empty() || image->size() != size) return std::nullopt;
  }
  mask |= other_mask;
  const cv::Rect part = RunFolder::surroundings(mask);
  Pair pair{name, {}, {}, input(part), truth(part), a(part), b(part)};
  cv::Mat difference;
  cv::absdiff(pair.first, pair.second, difference);
  const cv::Scalar mean = cv::mean(difference);
  pair.difference = (mean[0] + mean[1] + mean[2]) / 3;
  return pair;
}

/// Four times the difference of two pictures.
cv::Mat amplified_difference(const cv::Mat& a, const cv::Mat& b) {
  constexpr double amplification = 4;
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  difference.convertTo(difference, -1, amplification);
  return difference;
}

std::string show(const Pair& pair) {
  std::string text = fmt::format("<h3>{}</h3>\n", html::escaped(pair.name));
  text += html::slider({{"first", pair.first},
                        {"second", pair.second},
                        {"truth", pair.truth},
                        {"input", pair.input},
                        {"difference", amplified_difference(pair.first, pair.second)},
                        {"first-error", amplified_difference(pair.first, pair.truth)},
                        {"second-error", amplified_difference(pair.second, pair.truth)}},
                       "first", "second");
  if (!pair.first_quality || !pair.second_quality) return text;
  return text + fmt::format("<p>PSNR {:.2f} and {:.2f} dB, SSIM {:.3f} and {:.3f}</p>\n",
                            pair.first_quality->psnr_db, pair.second_quality->psnr_db,
                            pair.first_quality->ssim, pair.second_quality->ssim);
}

const FrameScore* find(const Score& score, const std::string& name) {
  const auto found = std::find_if(score.frames.begin(), score.frames.end(),
                                  [&](const FrameScore& frame) { return frame.name == name; });
  return found == score.frames.end() ? nullptr : &*found;
}

}  // namespace

void write_comparison(const std::filesystem::path& recording, const std::filesystem::path& first,
                      const std::filesystem::path& second, const std::filesystem::path& file,
                      int most_frames) {
  const Score first_score = score_run(recording, first);
  const Score second_score = score_run(recording, second);
  const RunFolder first_folder(recording, first);
  const RunFolder second_folder(recording, second);

  std::vector<Pair> pairs;
  std::vector<std::optional<double>> gains;
  for (const FrameScore& frame : first_score.frames) {
    const FrameScore* const other = find(second_score, frame.name);
    if (!other) continue;
    std::optional<double>& gain = gains.emplace_back();
    if (frame.inside && other->inside) gain = other->inside->psnr_db - frame.inside->psnr_db;
    std::optional<Pair> pair = find_pair(first_folder, second_folder, frame.name);
    if (!pair) continue;
    pair->first_quality = frame.inside;
    pair->second_quality = other->inside;
    // No more pictures are kept than are shown.
    const auto differs_more = [](const Pair& a, const Pair& b) {
      return a.difference > b.difference;
    };
    pairs.insert(std::upper_bound(pairs.begin(), pairs.end(), *pair, differs_more), *pair);
    if (pairs.size() > static_cast<std::size_t>(most_frames)) pairs.pop_back();
  }
  if (gains.empty()) {
    throw Error(Error::input, fmt::format("{}: expected frames that {} has, too", second.string(),
                                          first.string()));
  }

  std::string page = fmt::format("<h1>{}</h1>\n<p>first: {}<br>second: {}</p>\n",
                                 html::escaped(recording.filename().string()),
                                 html::escaped(first.string()), html::escaped(second.string()));
  page += figures_table(first_score, second_score);
  page += options_table(read_run_summary(first), read_run_summary(second));
  page += "<h2>PSNR by frame</h2>\n<div class=plots>" + html::plot("second - first, dB", gains) +
          "</div>\n";
  page += "<h2>The frames that differ most</h2>\n";
  for (const Pair& pair : pairs) page += show(pair);
  write_file(file, html::page("diminish compare", page));
}

}  // namespace diminish
