#include "diminish/report.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "diminish/diminished_frame.h"
#include "diminish/error.h"
#include "diminish/score.h"
#include "score/csv_table.h"
#include "score/html.h"
#include "score/run_folder.h"
#include "score/run_summary.h"
#include "sink/partial_file.h"
#include "sink/shares.h"
#include "sink/time_table.h"

namespace diminish {
namespace {

constexpr std::size_t most_pictures = 8;

using FrameFigure = std::function<std::optional<double>(const FrameScore&)>;

std::string plots(const std::vector<FrameScore>& frames) {
  const auto quality = [](std::optional<Quality> FrameScore::*part,
                          double Quality::*figure) -> FrameFigure {
    return [=](const FrameScore& frame) {
      return frame.*part ? std::optional((*(frame.*part)).*figure) : std::nullopt;
    };
  };
  std::vector<std::pair<std::string, FrameFigure>> figures = {
      {"PSNR inside, dB", quality(&FrameScore::inside, &Quality::psnr_db)},
      {"SSIM inside", quality(&FrameScore::inside, &Quality::ssim)},
      {"PSNR of seen pixels, dB", quality(&FrameScore::valid, &Quality::psnr_db)},
      {"PSNR of invented pixels, dB", quality(&FrameScore::missing, &Quality::psnr_db)},
      {"edges, F1",
       [](const FrameScore& frame) {
         return frame.viewer ? std::optional(frame.viewer->edge_f1) : std::nullopt;
       }},
      {"sharpness of seen pixels",
       [](const FrameScore& frame) {
         return frame.viewer ? frame.viewer->sharpness_seen : std::nullopt;
       }},
      {"sharpness of invented pixels",
       [](const FrameScore& frame) {
         return frame.viewer ? frame.viewer->sharpness_invented : std::nullopt;
       }},
      {"coverage", [](const FrameScore& frame) { return frame.coverage; }},
      {"mask IoU", [](const FrameScore& frame) { return frame.mask_iou; }}};
  std::map<std::string, bool> poses;
  for (const FrameScore& frame : frames) {
    for (const auto& [name, error] : frame.poses) poses[name] = true;
  }
  for (const auto& [name, present] : poses) {
    figures.emplace_back(name + ", degrees off",
                         [name = name](const FrameScore& frame) -> std::optional<double> {
                           const auto found = frame.poses.find(name);
                           if (found == frame.poses.end()) return std::nullopt;
                           return found->second.rotation_deg;
                         });
  }
  std::string text = "<div class=plots>\n";
  for (const auto& [title, figure] : figures) {
    std::vector<std::optional<double>> values;
    values.reserve(frames.size());
    for (const FrameScore& frame : frames) values.push_back(figure(frame));
    text += html::plot(title, values);
  }
  return text + "</div>\n";
}

/// A column's numbers; nothing where the cell is empty or the column is not there.
std::vector<std::optional<double>> numbers_in(const std::vector<CsvRow>& rows,
                                              const std::string& column,
                                              const std::filesystem::path& file) {
  std::vector<std::optional<double>> numbers;
  for (const CsvRow& row : rows) {
    std::optional<double>& number = numbers.emplace_back();
    const auto cell = row.find(column);
    if (cell == row.end() || cell->second.empty()) continue;
    number = parse_number(cell->second);
    if (!number) {
      throw Error(Error::input,
                  fmt::format("{}: row {}: {}: expected a number, got '{}'", file.string(),
                              numbers.size(), column, printable(cell->second)));
    }
  }
  return numbers;
}

std::string time_plots(const std::filesystem::path& file) {
  const std::vector<CsvRow> rows = load_csv(file);
  const auto plot = [&](const TimeRow& row) {
    return html::plot(std::string(row.title) + ", ms",
                      numbers_in(rows, std::string(row.key) + "_ms", file));
  };
  std::string text = "<div class=plots>\n";
  for (const TimeRow& row : time_rows().first<stage_count>()) text += plot(row);
  return text + plot(time_rows()[whole_frame_row]) + "</div>\n";
}

std::string time_table(const nlohmann::json& summary) {
  std::string text = "<table>\n";
  const auto& times = summary.at("milliseconds");
  for (const TimeGroup& group : time_groups) {
    text +=
        fmt::format("<tr><th>{}<th>avg<th>min<th>max<th>{}</tr>\n", group.title, group.paper_title);
    for (const TimeRow& row : time_rows().subspan(group.begin, group.end - group.begin)) {
      const auto& time = times.at(row.key);
      text += fmt::format("<tr><td>{}<td>{:.2f}<td>{:.2f}<td>{:.2f}<td>{}</tr>\n", row.title,
                          time.at("avg").get<double>(), time.at("min").get<double>(),
                          time.at("max").get<double>(), row.paper_ms);
    }
  }
  return text + "</table>\n";
}

std::string sharpness_text(const ViewerFigures& viewer) {
  std::string text;
  if (viewer.sharpness_seen) {
    text += fmt::format("; sharpness of seen pixels {:.2f}", *viewer.sharpness_seen);
  }
  if (viewer.sharpness_invented) {
    text += fmt::format("; sharpness of invented pixels {:.2f}", *viewer.sharpness_invented);
  }
  return text;
}

std::string provenance_bar(const nlohmann::json& summary) {
  const auto& pixels = summary.at("pixels");
  const auto count = [&](const char* name) { return pixels.at(name).get<std::size_t>(); };
  if (count("mask") == 0) return {};
  const Shares shares = shares_of(count("mask"), count("valid"), count("witnessed"),
                                  count("remembered"), pixels.value("estimated", std::size_t{0}));
  std::string text = "<div class=bar>";
  const auto part = [&](const char* name, const char* color, double share) {
    if (share > 0) {
      text += fmt::format("<div style='width:{:.1f}%;background:{}'>{}</div>", 100 * share, color,
                          name);
    }
  };
  part("seen", "#283", shares.seen - shares.witnessed);
  part("witnessed", "#197", shares.witnessed);
  part("remembered", "#b70", shares.remembered);
  part("without depth", "#77b", shares.estimated);
  part("invented", "#a2a", shares.invented);
  text += "</div>\n<p>Of the objects' pixels " + to_text(shares, 1);
  if (summary.contains("remembered_age_s")) {
    const auto& age_s = summary["remembered_age_s"];
    text +=
        fmt::format("; the remembered ones were seen {:.1f} s before (median), the oldest {:.1f} s",
                    age_s.at("median").get<double>(), age_s.at("oldest").get<double>());
  }
  return text + ".</p>\n";
}

std::string origins_table(const FrameScore::Origins& origins) {
  std::string rows;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (!origins[i]) continue;
    rows +=
        fmt::format("<tr><td>{}<td>{:.1f} %<td>{:.2f}<td>{:.3f}</tr>\n", score_origins[i],
                    100 * origins[i]->share, origins[i]->quality.psnr_db, origins[i]->quality.ssim);
  }
  if (rows.empty()) return rows;
  return "<table><tr><th>pixels<th>share<th>PSNR, dB<th>SSIM</tr>\n" + rows + "</table>\n";
}

std::string before_and_after(const RunFolder& folder, const FrameScore& frame) {
  const auto pictures = folder.object_pictures(frame.name);
  if (!pictures) return {};
  std::string text = fmt::format("<h3>{}</h3>", html::escaped(frame.name));
  text += html::slider(
      {{"input", pictures->input}, {"result", pictures->result}, {"truth", pictures->truth}},
      "input", "result");
  if (frame.inside) {
    text += fmt::format("<p>PSNR {:.2f} dB, SSIM {:.3f}</p>\n", frame.inside->psnr_db,
                        frame.inside->ssim);
  }
  return text;
}

}  // namespace

void write_report(const std::filesystem::path& recording, const std::filesystem::path& run,
                  const std::filesystem::path& file) {
  const Score score = score_run(recording, run);
  const RunFolder folder(recording, run);
  const nlohmann::json summary = read_run_summary(run);
  std::string page;
  page += fmt::format("<h1>{}</h1>\n", html::escaped(recording.filename().string()));
  try {
    if (score.mean.inside) {
      page += fmt::format("<p>PSNR {:.2f} dB, SSIM {:.3f} inside the object's mask",
                          score.mean.inside->psnr_db, score.mean.inside->ssim);
      if (const auto& viewer = score.mean.viewer) {
        page += fmt::format("; edges: recall {:.3f}, precision {:.3f}, F1 {:.3f}",
                            viewer->edge_recall, viewer->edge_precision, viewer->edge_f1);
        page += sharpness_text(*viewer);
        page += fmt::format("; gradients alike {:.3f}", viewer->gradient_similarity);
      }
      if (score.flicker) page += fmt::format("; flicker {:.1f} grey levels", *score.flicker);
      page += fmt::format("; {} frames.</p>\n", score.frames.size());
    }
    page += provenance_bar(summary);
    page += origins_table(score.mean.origins);
    page += "<h2>Before and after</h2>\n";
    const std::size_t step = (score.frames.size() + most_pictures - 1) / most_pictures;
    for (std::size_t i = 0; i < score.frames.size(); i += step) {
      page += before_and_after(folder, score.frames[i]);
    }
    page += "<h2>Figures by frame</h2>\n" + plots(score.frames);
    page += "<h2>Times</h2>\n" + time_table(summary);
    page += "<h2>Milliseconds by frame</h2>\n" + time_plots(run / "frames.csv");
    page += fmt::format("<h2>Options</h2><pre>{}</pre>\n",
                        html::escaped(summary.at("options").dump(2)));
  } catch (const nlohmann::json::exception& error) {
    throw Error(Error::input,
                fmt::format("{}: expected the summary that `diminish run` writes: {}",
                            (run / "summary.json").string(), printable(error.what())));
  }
  write_file(file, html::page("diminish report", page));
}

}  // namespace diminish
