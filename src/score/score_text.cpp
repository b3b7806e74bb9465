#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "diminish/score.h"

namespace diminish {
namespace {

std::string cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}
std::string cell(const std::optional<Quality>& quality) {
  return quality ? fmt::format("{:.2f} / {:.3f}", quality->psnr_db, quality->ssim) : "-";
}

std::string row(const FrameScore& frame) {
  return fmt::format("{:<12}{:>16}{:>16}{:>16}{:>10}{:>8}{:>8}{:>9}\n", frame.name,
                     cell(frame.inside), cell(frame.valid), cell(frame.missing),
                     cell(frame.coverage, 3), cell(frame.mask_iou, 3), cell(frame.mask_recall, 3),
                     frame.changed_outside ? std::to_string(*frame.changed_outside) : "-");
}

std::string line(const FrameScore::Origins& origins) {
  std::string text;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (!origins[i]) continue;
    text += fmt::format("{} {} {:.1f} % ({:.2f} dB / {:.3f})", text.empty() ? "By origin:" : ",",
                        score_origins[i], 100 * origins[i]->share, origins[i]->quality.psnr_db,
                        origins[i]->quality.ssim);
  }
  return text.empty() ? text : text + "\n";
}

std::string line(const ViewerFigures& viewer) {
  return fmt::format(
      "Edges: recall {:.3f}, precision {:.3f}, F1 {:.3f}; gradients alike {:.3f}; sharpness of "
      "seen pixels {}, of invented {}; invented: {:.3f} of all, {} dB / {}\n",
      viewer.edge_recall, viewer.edge_precision, viewer.edge_f1, viewer.gradient_similarity,
      cell(viewer.sharpness_seen, 3), cell(viewer.sharpness_invented, 3), viewer.invented_share,
      cell(viewer.invented ? std::optional(viewer.invented->psnr_db) : std::nullopt, 3),
      cell(viewer.invented ? std::optional(viewer.invented->ssim) : std::nullopt, 3));
}

nlohmann::ordered_json to_json(const ViewerFigures& viewer) {
  nlohmann::ordered_json json = {{"edge_recall", viewer.edge_recall},
                                 {"edge_precision", viewer.edge_precision},
                                 {"edge_f1", viewer.edge_f1},
                                 {"gradient_similarity", viewer.gradient_similarity},
                                 {"invented_share", viewer.invented_share}};
  if (viewer.sharpness_seen) json["sharpness_seen"] = *viewer.sharpness_seen;
  if (viewer.sharpness_invented) json["sharpness_invented"] = *viewer.sharpness_invented;
  if (viewer.invented) {
    json["invented"] = {{"psnr_db", viewer.invented->psnr_db}, {"ssim", viewer.invented->ssim}};
  }
  return json;
}

nlohmann::ordered_json to_json(const FrameScore& frame) {
  nlohmann::ordered_json json;
  json["name"] = frame.name;
  const auto add_quality = [&](const char* name, const std::optional<Quality>& quality) {
    if (quality) json[name] = {{"psnr_db", quality->psnr_db}, {"ssim", quality->ssim}};
  };
  add_quality("inside", frame.inside);
  add_quality("valid", frame.valid);
  add_quality("missing", frame.missing);
  for (std::size_t i = 0; i < frame.origins.size(); ++i) {
    const std::optional<OriginScore>& origin = frame.origins[i];
    if (!origin) continue;
    json["origins"][score_origins[i]] = {{"share", origin->share},
                                         {"psnr_db", origin->quality.psnr_db},
                                         {"ssim", origin->quality.ssim}};
  }
  if (frame.viewer) json["viewer"] = to_json(*frame.viewer);
  if (frame.budget) {
    for (std::size_t i = 0; i < error_causes.size(); ++i) {
      json["error_budget"][error_causes[i]] = (*frame.budget)[i];
    }
  }
  if (frame.coverage) json["coverage"] = *frame.coverage;
  if (frame.mask_iou) json["mask_iou"] = *frame.mask_iou;
  if (frame.mask_recall) json["mask_recall"] = *frame.mask_recall;
  if (frame.changed_outside) json["changed_outside"] = *frame.changed_outside;
  for (const auto& [name, error] : frame.poses) {
    json["poses"][name] = {{"position_mm", error.position_mm},
                           {"rotation_deg", error.rotation_deg}};
  }
  return json;
}

}  // namespace

std::string score_table(const Score& score) {
  std::string text =
      fmt::format("{:<12}{:>16}{:>16}{:>16}{:>10}{:>8}{:>8}{:>9}\n", "PSNR / SSIM", "inside",
                  "seen", "not seen", "coverage", "IoU", "recall", "changed");
  for (const FrameScore& frame : score.frames) text += row(frame);
  text += row(score.mean);
  text += fmt::format("PSNR of all frames' error {} dB, flicker {} levels\n",
                      cell(score.psnr_pooled_db, 2), cell(score.flicker, 2));
  text += line(score.mean.origins);
  if (score.mean.viewer) text += line(*score.mean.viewer);
  if (score.mean.budget) {
    text += "Squared error by cause:";
    for (std::size_t i = 0; i < error_causes.size(); ++i) {
      text += fmt::format("{} {} {:.0f} %", i == 0 ? "" : ",", error_causes[i],
                          100 * (*score.mean.budget)[i]);
    }
    text += "\n";
  }
  for (const auto& [name, error] : score.mean.poses) {
    text += fmt::format("{}: {:.1f} mm, {:.2f} degrees off\n", name, error.position_mm,
                        error.rotation_deg);
  }
  for (const std::string& name : score.not_written) text += name + ": not written by this run\n";
  return text;
}

std::string score_json(const Score& score) {
  nlohmann::ordered_json json;
  json["mean"] = to_json(score.mean);
  json["mean"].erase("name");
  if (score.psnr_pooled_db) json["psnr_pooled_db"] = *score.psnr_pooled_db;
  if (score.flicker) json["flicker"] = *score.flicker;
  json["not_written"] = score.not_written;
  json["frames"] = nlohmann::json::array();
  for (const FrameScore& frame : score.frames) json["frames"].push_back(to_json(frame));
  // File names need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace diminish
