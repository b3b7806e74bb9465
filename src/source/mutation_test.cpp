#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "geometry/triangle_mesh.h"
#include "paths.h"
#include "source/stream_list.h"

namespace diminish {
namespace {

const std::filesystem::path recording = testing::recordings_dir() + "/workbench";

/// What people and disks do to files: change characters, and delete, duplicate and move parts.
std::string mutate(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return random() % end; };
  const std::string characters = "0123456789.-+e:,[]{}#&*'\"\n\t /\\%\x7f\xff~xN";
  for (std::size_t changes = 1 + below(4); changes > 0 && text.size() > 1; --changes) {
    const std::size_t at = below(text.size());
    const std::string piece = text.substr(at, 1 + below(20));
    switch (below(5)) {
      case 0:
        text[at] = characters[below(characters.size())];
        break;
      case 1:
        text.insert(at, 1, characters[below(characters.size())]);
        break;
      case 2:
        text.erase(at, piece.size());
        break;
      case 3:
        text.insert(below(text.size()), piece);
        break;
      default:
        text.resize(at);
    }
  }
  return text;
}

/// Feeds seeded mutations of a file to its reader. It must read them or throw Error. Both must
/// happen, or else the mutations prove nothing.
void expect_result_or_error(const std::string& file,
                            const std::function<void(const std::string&)>& read) {
  const std::string original = read_text_file(recording / file, 1 << 20);
  ASSERT_NO_THROW(read(original));
  std::mt19937 random(7);
  int accepted = 0;
  int rejected = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = mutate(original, random);
    try {
      read(text);
      ++accepted;
    } catch (const Error& error) {
      ++rejected;
      EXPECT_EQ(std::string(error.what()).rfind(file, 0), 0U) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    } catch (const std::exception& error) {
      FAIL() << "not an Error: " << error.what() << "\n" << text;
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(rejected, 200);
}

TEST(Mutations, Rig) {
  expect_result_or_error(
      "rig.yaml", [](const std::string& text) { read_rig(Config::parse(text, "rig.yaml")); });
}

TEST(Mutations, Scene) {
  expect_result_or_error(
      "scene.yaml", [](const std::string& text) { read_scene(Config::parse(text, "scene.yaml")); });
}

TEST(Mutations, Mesh) {
  expect_result_or_error("lamp.obj", [](const std::string& text) {
    std::istringstream stream(text);
    read_obj(stream, "lamp.obj");
  });
}

TEST(Mutations, StreamList) {
  expect_result_or_error("color.txt", [](const std::string& text) {
    std::istringstream stream(text);
    read_stream_list(stream, "color.txt");
  });
}

}  // namespace
}  // namespace diminish
