#include "diminish/marker_sheet.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <set>

#include "core/text.h"
#include "expect_error.h"
#include "pose/opencv_aruco.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t max_bytes = 1 << 24;

/// The resolution that a PNG file states.
double pixels_per_metre(const std::string& bytes) {
  const std::size_t at = bytes.find("pHYs");
  if (at == std::string::npos) return 0;
  EXPECT_EQ(bytes[at + 12], 1) << "the unit is the metre";
  double value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value * 256 + static_cast<unsigned char>(bytes[at + 4 + i]);
  }
  return value;
}

struct Drawing {
  std::vector<cv::Rect2d> black;  ///< millimetres from the page's top left

  bool is_black(double x, double y) const {
    return std::any_of(black.begin(), black.end(), [&](const cv::Rect2d& r) {
      return r.contains({x, y});
    });
  }
};

double number(const std::ssub_match& match) {
  return std::stod(match.str());
}

template <class Add>
void for_each_match(const std::string& text, const char* pattern, Add&& add) {
  const std::regex regex(pattern);
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i) add(*i);
}

Drawing parse_svg(const std::string& svg) {
  Drawing drawing;
  for_each_match(svg, R"(M(\S+) (\S+)h(\S+)v(\S+)h(\S+)z)", [&](const std::smatch& m) {
    EXPECT_EQ(number(m[5]), -number(m[3]));
    drawing.black.emplace_back(number(m[1]), number(m[2]), number(m[3]), number(m[4]));
  });
  return drawing;
}

/// By the transform that the file sets (from millimetres to points, y downwards) to points, and
/// from these to millimetres by the height of MediaBox.
Drawing parse_pdf(const std::string& pdf) {
  std::smatch box;
  std::smatch transform;
  EXPECT_TRUE(std::regex_search(pdf, box, std::regex(R"(MediaBox \[0 0 (\S+) (\S+)\])")));
  EXPECT_TRUE(std::regex_search(pdf, transform, std::regex(R"((\S+) 0 0 (\S+) 0 (\S+) cm)")));
  const double mm = 25.4 / 72;
  const double height = number(box[2]);
  Drawing drawing;
  for_each_match(pdf, R"((\S+) (\S+) (\S+) (\S+) re)", [&](const std::smatch& m) {
    const double x = number(transform[1]) * number(m[1]);
    const double y = number(transform[2]) * number(m[2]) + number(transform[3]);
    drawing.black.emplace_back(mm * x, mm * (height - y), mm * number(transform[1]) * number(m[3]),
                               -mm * number(transform[2]) * number(m[4]));
  });
  return drawing;
}

opencv_aruco::Dictionary dictionary_5x5() {
  return opencv_aruco::dictionary(cv::aruco::DICT_5X5_100);
}

/// Reads a marker's cells where it should be, by OpenCV's dictionary; -1: it is none.
int identify(const Drawing& drawing, double x, double y, double size_mm) {
  constexpr int cells = 5;
  const double cell = size_mm / (cells + 2);
  cv::Mat bits(cells, cells, CV_8U);
  for (int row = -1; row <= cells; ++row) {
    for (int column = -1; column <= cells; ++column) {
      const bool black = drawing.is_black(x + (column + 1.5) * cell, y + (row + 1.5) * cell);
      const bool border = row < 0 || column < 0 || row == cells || column == cells;
      if (border && !black) return -1;
      if (!border) bits.at<std::uint8_t>(row, column) = black ? 0 : 1;
    }
  }
  int id = -1;
  int rotation = -1;
  if (!dictionary_5x5()->identify(bits, id, rotation, 0) || rotation != 0) return -1;
  return id;
}

class MarkerSheetTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name) {
    write_marker_sheet(sheet, find_paper("A4"), folder.path() / name);
    return read_text_file(folder.path() / name, max_bytes);
  }
  static opencv_aruco::Corners detect(const cv::Mat& picture,
                                      const opencv_aruco::Dictionary& dictionary,
                                      std::vector<int>& ids) {
    opencv_aruco::Corners corners;
    opencv_aruco::detect(picture, dictionary, false, corners, ids);
    return corners;
  }

  TemporaryFolder folder;
  MarkerSheet sheet{"DICT_5X5_100", {0, 17, 42, 99, 3, 8}, 0.0537, 1};
};

TEST_F(MarkerSheetTest, OpenCVFindsEveryMarkerInThePngAtItsSize) {
  const std::string bytes = write("sheet.png");
  const double per_metre = pixels_per_metre(bytes);
  EXPECT_NEAR(per_metre, 600 / 0.0254, 0.05 * 600 / 0.0254);
  const cv::Mat picture = cv::imread((folder.path() / "sheet.png").string(), cv::IMREAD_GRAYSCALE);
  EXPECT_NEAR(picture.cols, 0.210 * per_metre, 1);
  EXPECT_NEAR(picture.rows, 0.297 * per_metre, 1);
  std::vector<int> ids;
  const auto corners = detect(picture, dictionary_5x5(), ids);
  EXPECT_EQ(std::multiset<int>(ids.begin(), ids.end()),
            std::multiset<int>(sheet.ids.begin(), sheet.ids.end()));
  for (const auto& c : corners) {
    // Corner pixels' centres are a pixel less apart than the outer edges.
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR((cv::norm(c[i] - c[(i + 1) % 4]) + 1) / per_metre, sheet.size_m, 0.00005);
    }
  }
}

TEST_F(MarkerSheetTest, SvgAndPdfHoldTheSameSquaresAndTheyAreTheMarkers) {
  const std::string svg = write("sheet.svg");
  EXPECT_THAT(svg, HasSubstr("width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\""));
  EXPECT_THAT(svg, HasSubstr("DICT_5X5_100 id 42, 53.7 mm"));
  const Drawing from_svg = parse_svg(svg);
  const Drawing from_pdf = parse_pdf(write("sheet.pdf"));
  ASSERT_EQ(from_svg.black.size(), from_pdf.black.size());
  for (std::size_t i = 0; i < from_svg.black.size(); ++i) {
    EXPECT_NEAR(from_svg.black[i].x, from_pdf.black[i].x, 0.001);
    EXPECT_NEAR(from_svg.black[i].y, from_pdf.black[i].y, 0.001);
    EXPECT_NEAR(from_svg.black[i].width, from_pdf.black[i].width, 0.001);
    EXPECT_NEAR(from_svg.black[i].height, from_pdf.black[i].height, 0.001);
  }
  // Where the PNG has them, so has the drawing.
  write("sheet.png");
  const double per_mm =
      pixels_per_metre(read_text_file(folder.path() / "sheet.png", max_bytes)) / 1000;
  std::vector<int> ids;
  const auto corners =
      detect(cv::imread((folder.path() / "sheet.png").string()), dictionary_5x5(), ids);
  ASSERT_EQ(ids.size(), sheet.ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(identify(from_svg, corners[i][0].x / per_mm, corners[i][0].y / per_mm, 53.7), ids[i]);
  }
}

TEST_F(MarkerSheetTest, TheRulerIsAHundredMillimetres) {
  const Drawing drawing = parse_svg(write("sheet.svg"));
  std::vector<double> centres;
  for (const cv::Rect2d& r : drawing.black) {
    if (std::abs(r.height - 4) < 1e-3) centres.push_back(r.x + r.width / 2);
  }
  ASSERT_EQ(centres.size(), 11U);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    EXPECT_NEAR(centres[i] - centres[0], 10.0 * static_cast<double>(i), 1e-3);
  }
}

TEST_F(MarkerSheetTest, NothingIsOffThePageNorInAQuietZone) {
  const Drawing drawing = parse_svg(write("sheet.svg"));
  for (const cv::Rect2d& r : drawing.black) {
    EXPECT_GE(r.x, 5);
    EXPECT_LE(r.br().x, 205);
    EXPECT_GE(r.y, 5);
    EXPECT_LE(r.br().y, 292);
  }
  const double cell = 53.7 / 7;
  for (int mm = 0; mm < 53.6 + 2 * cell; ++mm) {
    const double x = mm + 0.1;
    EXPECT_FALSE(drawing.is_black(10 + x, 10 + 0.5 * cell)) << x;
    EXPECT_FALSE(drawing.is_black(10 + 0.5 * cell, 10 + x)) << x;
  }
}

TEST_F(MarkerSheetTest, APdfIsWellFormedAndHasAsManyPagesAsItTakes) {
  sheet.ids.clear();
  for (int id = 0; id < 20; ++id) sheet.ids.push_back(id);
  const std::string pdf = write("sheet.pdf");
  EXPECT_EQ(pdf.rfind("%PDF-1.4\n", 0), 0U);
  std::size_t pages = 0;
  for_each_match(pdf, R"(/Type /Page /Parent 2 0 R /MediaBox \[0 0 (\S+) (\S+)\])",
                 [&](const std::smatch& m) {
                   EXPECT_NEAR(number(m[1]), 210 / 25.4 * 72, 0.001);
                   EXPECT_NEAR(number(m[2]), 297 / 25.4 * 72, 0.001);
                   ++pages;
                 });
  EXPECT_EQ(pages, 4U) << "2 x 3 a page";
  for (int id = 0; id < 20; ++id) {
    EXPECT_THAT(pdf, HasSubstr("(DICT_5X5_100 id " + std::to_string(id) + ", 53.7 mm) Tj"));
  }
  std::smatch start;
  ASSERT_TRUE(std::regex_search(pdf, start, std::regex(R"(startxref\n(\d+)\n%%EOF\n$)")));
  const std::string table = pdf.substr(std::stoul(start[1]));
  EXPECT_EQ(table.rfind("xref\n", 0), 0U);
  int object = 0;
  for_each_match(table, R"((\d{10}) 00000 n \n)", [&](const std::smatch& m) {
    const std::string head = std::to_string(++object) + " 0 obj\n";
    EXPECT_EQ(pdf.compare(std::stoul(m[1]), head.size(), head), 0) << object;
  });
  EXPECT_EQ(object, 11);
  for_each_match(pdf, R"(/Length (\d+) >>\nstream\n)", [&](const std::smatch& m) {
    const auto end = static_cast<std::size_t>(m.position() + m.length()) + std::stoul(m[1]);
    EXPECT_EQ(pdf.compare(end, 9, "endstream"), 0);
  });
}

TEST_F(MarkerSheetTest, SaysWhatCannotBePrinted) {
  EXPECT_THAT(error_of([] { find_paper("A5"); }), HasSubstr("A4, A3, letter"));
  EXPECT_THAT(error_of([&] { write("sheet.gif"); }), HasSubstr("sheet.gif: expected"));
  sheet.ids = {100};
  EXPECT_THAT(error_of([&] { write("sheet.pdf"); }), HasSubstr("from 0 to 99, got 100"));
  sheet.ids = {1, 2};
  sheet.size_m = 0.2;
  EXPECT_THAT(error_of([&] { write("sheet.pdf"); }), HasSubstr("at most 147 mm"));
  sheet.size_m = 0.147;
  write("sheet.pdf");
  EXPECT_THAT(error_of([&] { write("sheet.svg"); }), HasSubstr("2 pages"));
  sheet.dictionary = "DICT_9X9";
  EXPECT_THAT(error_of([&] { write("sheet.pdf"); }), HasSubstr("DICT_9X9"));
}

class CharucoBoardTest : public ::testing::TestWithParam<const char*> {};

TEST_P(CharucoBoardTest, OpenCVFindsAllItsCornersWhereTheyBelong) {
  const TemporaryFolder folder;
  const Board board = parse_board(GetParam());
  EXPECT_EQ(describe(board), GetParam());
  const auto file = folder.path() / "board.png";
  write_board(board, find_paper("A4"), file);
  const double per_metre = pixels_per_metre(read_text_file(file, max_bytes));
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  const auto dictionary = opencv_aruco::dictionary(cv::aruco::DICT_4X4_50);
  const auto opencv =
      opencv_aruco::make_board({board.columns, board.rows}, static_cast<float>(board.square_m),
                               static_cast<float>(board.marker_m), dictionary);
  opencv_aruco::Corners markers;
  std::vector<int> ids;
  opencv_aruco::detect(picture, dictionary, false, markers, ids);
  EXPECT_EQ(ids.size(), opencv_aruco::marker_ids(opencv).size());
  std::vector<cv::Point2f> corners;
  std::vector<int> corner_ids;
  opencv_aruco::detect_corners(picture, opencv, corners, corner_ids);
  const std::vector<cv::Point3f> on_board = opencv_aruco::corners(opencv);
  ASSERT_EQ(corners.size(), on_board.size());
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const auto expected = on_board[static_cast<std::size_t>(corner_ids[i])] -
                          on_board[static_cast<std::size_t>(corner_ids[0])];
    const cv::Point2f seen = (corners[i] - corners[0]) / per_metre;
    EXPECT_NEAR(std::abs(seen.x), std::abs(expected.x), 0.0001);
    EXPECT_NEAR(std::abs(seen.y), std::abs(expected.y), 0.0001);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CharucoBoardTest,
                         ::testing::Values("charuco:7x5:30:22:DICT_4X4_50",
                                           "charuco:6x8:22.5:15:DICT_4X4_50",
                                           "charuco:5x7:30:22:DICT_4X4_50"));

TEST(CheckerboardSheet, OpenCVFindsItsInnerCorners) {
  const TemporaryFolder folder;
  const Board board = parse_board("checkerboard:9x6:25");
  const auto file = folder.path() / "board.png";
  write_board(board, find_paper("A4"), file);
  const double per_metre = pixels_per_metre(read_text_file(file, max_bytes));
  cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  EXPECT_GT(picture.cols, picture.rows) << "it lies";
  constexpr double scale = 0.25;
  cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
  std::vector<cv::Point2f> corners;
  ASSERT_TRUE(cv::findChessboardCornersSB(picture, {9, 6}, corners));
  const double metre_px = per_metre * scale;
  EXPECT_NEAR(cv::norm(corners[1] - corners[0]) / metre_px, 0.025, 0.0001);
  EXPECT_NEAR(cv::norm(corners[53] - corners[0]) / metre_px, std::hypot(8 * 0.025, 5 * 0.025),
              0.0001);
}

TEST(ParseBoard, SaysWhatIsWrong) {
  EXPECT_THAT(error_of([] { parse_board("chess:9x6:25"); }), HasSubstr("checkerboard:COLUMNS"));
  EXPECT_THAT(error_of([] { parse_board("checkerboard:9:25"); }), HasSubstr("checkerboard:COLU"));
  EXPECT_THAT(error_of([] { parse_board("checkerboard:9x2:25"); }), HasSubstr("'2'"));
  EXPECT_THAT(error_of([] { parse_board("checkerboard:9x6:0"); }), HasSubstr("millimetres"));
  EXPECT_THAT(error_of([] { parse_board("charuco:7x5:30:30"); }), HasSubstr("smaller"));
  EXPECT_THAT(error_of([] { parse_board("charuco:20x20:30:20"); }), HasSubstr("200 markers"));
  EXPECT_THAT(error_of([] { parse_board("charuco:7x5:30:20:DICT"); }), HasSubstr("DICT_4X4_50"));
  EXPECT_EQ(describe(parse_board("charuco:7x5:30:22")), "charuco:7x5:30:22:DICT_4X4_50");
}

}  // namespace
}  // namespace diminish
