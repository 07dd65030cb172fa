// SPDX-License-Identifier: Apache-2.0
// PNG, contact sheets and plots.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/image/contact_sheet.h"
#include "common/image/png.h"
#include "common/image/svg_plot.h"
#include "common/image/tiny_font.h"

namespace farfield {
namespace {

Image8 gradient(int width, int height, int channels) {
  Image8 image(width, height, channels);
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = static_cast<std::uint8_t>(i * 37 + i / 7);
  return image;
}

class PngFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("farfield_png_" + std::to_string(std::hash<std::string>()(testing::TempDir())) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::filesystem::path folder_;
};

TEST_F(PngFile, RoundTripsAllChannelCounts) {
  for (const int channels : {1, 3, 4}) {
    const Image8 image = gradient(19, 7, channels);
    ASSERT_TRUE(write_png(path("a.png"), image).has_value());
    const auto back = read_png(path("a.png"), channels);
    ASSERT_TRUE(back.has_value()) << back.error().message;
    EXPECT_EQ(back->width, 19);
    EXPECT_EQ(back->values, image.values);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // no temporary file stays
}

TEST_F(PngFile, SaysWhatIsWrong) {
  const auto missing = read_png(path("missing.png"));
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  std::ofstream(path("text.png")) << "this is not an image";
  const auto text = read_png(path("text.png"));
  ASSERT_FALSE(text.has_value());
  EXPECT_EQ(text.error().code, ErrorCode::kBadData);
  EXPECT_NE(text.error().message.find("text.png"), std::string::npos);
  const Status nowhere = write_png(path("no/such/folder.png"), gradient(2, 2, 3));
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, ErrorCode::kIo);
  EXPECT_FALSE(write_png(path("empty.png"), Image8()).has_value());
}

TEST_F(PngFile, AFullDiskIsReportedAndLeavesNothing) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  std::filesystem::create_symlink("/dev/full", path("b.png"));
  const Status status = write_png(path("b.png"), gradient(64, 64, 3));
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::kIo);
  EXPECT_NE(status.error().message.find("b.png"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_symlink(path("b.png"))) << "a device is not replaced";
  std::filesystem::remove(path("b.png"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(Png, TruncatedBytesAreAnError) {
  const auto bytes = encode_png(gradient(50, 40, 3));
  ASSERT_TRUE(bytes.has_value());
  for (std::size_t size = 0; size + 12 < bytes->size(); size += 97) {
    EXPECT_FALSE(decode_png(ByteView(bytes->data(), size)).has_value()) << size;
  }
}

TEST(Png, HugeSizesAreRefusedBeforeAllocating) {
  auto bytes = encode_png(gradient(2, 2, 3)).value();
  for (int k = 16; k < 24; ++k) bytes[k] = (k % 4 == 1) ? 0x7f : 0;  // width and height of the header: 8.3 million
  const auto image = decode_png(bytes);
  ASSERT_FALSE(image.has_value());
}

TEST(ContactSheet, PlacesImagesWithGapsBelowTheirLabels) {
  const SheetOptions options{4, 1};
  const Image8 sheet = make_contact_sheet({{{"A", Image8(20, 10, 3, 200)}, {"B", Image8(8, 12, 4, 100)}},
                                           {{"LONG LABEL", Image8(9, 5, 3, 50)}}}, options);
  EXPECT_EQ(sheet.width, 4 + 20 + 4 + 8 + 4);
  EXPECT_EQ(sheet.height, 4 + 7 + 12 + 4 + 7 + 5 + 4);
  EXPECT_EQ(sheet.at(4, 11)[0], 200);
  EXPECT_EQ(sheet.at(23, 20)[0], 200);
  EXPECT_EQ(sheet.at(24, 20)[0], 32);
  EXPECT_EQ(sheet.at(28, 22)[0], 100);
  EXPECT_EQ(sheet.at(4, 34)[0], 50);
  EXPECT_EQ(sheet.at(5, 4)[0], 235);   // the tip of the A
  EXPECT_EQ(sheet.at(30, 27)[0], 32);  // labels end with their image
  EXPECT_EQ(make_contact_sheet({}).pixels(), 1u);
}

TEST(TinyFont, CutsTextAtTheImage) {
  Image8 image(10, 4, 3);
  draw_text(image, -2, -1, "HELLO 123", 2, {255, 255, 255});
  draw_text(image, 8, 2, "X", 3, {255, 255, 255});
  EXPECT_NE(std::count(image.values.begin(), image.values.end(), 255), 0);
}

TEST(SvgPlot, DrawsPointsAxesAndEscapedNames) {
  PlotOptions options;
  options.title = "error & time";
  options.log_x = true;
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string svg =
      render_svg_plot({{"a<b", {{1, 10}, {10, 20}, {100, 30}}}, {"c", {{0, 1}, {5, infinity}}, false}}, options);
  const auto count = [&](const std::string& what) {
    int found = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<circle"), 3 + 2);  // points, and one mark per name; what an axis cannot show is left out
  EXPECT_EQ(count("<polyline"), 1);
  EXPECT_EQ(count("a&lt;b"), 1);
  EXPECT_EQ(count("error &amp; time"), 1);
  EXPECT_EQ(count(">100<"), 1);  // a tick
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(render_svg_plot({}, {}).find("nan"), std::string::npos);
}

TEST(SvgPlot, PanelsStandSideBySideAndMarkedPointsHaveARing) {
  PlotSeries series{"a", {{1, 3}, {2, 2}, {3, 1}}};
  series.marked = 1;
  PlotOptions narrow;
  narrow.width_px = 400;
  const std::string svg = render_svg_plots({{{series}, narrow}, {{series}, {}}});
  EXPECT_NE(svg.find("width=\"1160\""), std::string::npos);
  EXPECT_NE(svg.find("translate(400 0)"), std::string::npos);
  int rings = 0;
  for (std::size_t at = svg.find("r=\"8\""); at != std::string::npos; at = svg.find("r=\"8\"", at + 1)) ++rings;
  EXPECT_EQ(rings, 2);
}

}  // namespace
}  // namespace farfield
