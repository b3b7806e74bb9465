#include "setup/keys/keys.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <sstream>

#include "dds/dds.h"
#include "dds/key_files.h"
#include "expect_error.h"
#include "ros2_domain.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
using dds::Delivery;
using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Keys : public ::testing::Test {
 protected:
  fs::path make(const std::string& store, const std::string& name, KeysRequest request = {}) {
    request.names = {name};
    return make_keys(folder_.path() / store, request).folders.at(0);
  }
  static std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  static unsigned mode(const fs::path& file) {
    struct stat state {};
    stat(file.c_str(), &state);
    return state.st_mode & 0777U;
  }

  TemporaryFolder folder_;
};

TEST_F(Keys, TheFolderIsAsSros2MakesThem) {
  const fs::path store = folder_.path() / "store";
  const KeysMade made = make_keys(store, {.names = {"camera", "lab/user"}});
  EXPECT_TRUE(made.is_new_authority);
  ASSERT_EQ(made.folders.size(), 2U);
  EXPECT_EQ(made.folders[0], store / "enclaves/camera");
  EXPECT_EQ(made.folders[1], store / "enclaves/lab/user");
  for (const char* file : {"public/identity_ca.cert.pem", "public/permissions_ca.cert.pem",
                           "private/identity_ca.key.pem", "private/permissions_ca.key.pem",
                           "enclaves/governance.p7s", "enclaves/governance.xml"}) {
    EXPECT_TRUE(fs::exists(store / file)) << file;
  }
  for (const fs::path& own : made.folders) {
    for (const char* file : {"identity_ca.cert.pem", "cert.pem", "key.pem",
                             "permissions_ca.cert.pem", "governance.p7s", "permissions.p7s"}) {
      EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(own / file))) << file;
    }
    EXPECT_NO_THROW(dds::check(dds::KeyFiles(own)));
    EXPECT_EQ(mode(own / "key.pem"), 0600U);
  }
  EXPECT_EQ(mode(store / "private/ca.key.pem"), 0600U);
  EXPECT_EQ(mode(store / "private"), 0700U);
  EXPECT_NE(text_of(made.folders[0] / "key.pem"), text_of(made.folders[1] / "key.pem"));
}

TEST_F(Keys, AnAuthorityGoesOn) {
  const fs::path first = make("store", "camera");
  const KeysMade made = make_keys(folder_.path() / "store", {.names = {"user"}});
  EXPECT_FALSE(made.is_new_authority);
  EXPECT_EQ(text_of(first / "identity_ca.cert.pem"),
            text_of(made.folders[0] / "identity_ca.cert.pem"));
  EXPECT_NO_THROW(dds::check(dds::KeyFiles(made.folders[0])));
  const std::string key = text_of(first / "key.pem");
  EXPECT_THAT(error_of([&] { make("store", "camera"); }),
              HasSubstr("camera/key.pem: expected a name that has no keys yet"));
  EXPECT_EQ(text_of(first / "key.pem"), key);
}

TEST_F(Keys, WhatIsMissingOrWrongIsNamed) {
  const fs::path own = make("store", "camera");
  const fs::path other = make("other", "camera");
  const fs::path beside = make("store", "user");
  const auto complaint = [&](const char* file, const std::string& text) {
    const std::string before = text_of(own / file);
    if (text.empty()) {
      fs::remove(own / file);
    } else {
      std::ofstream(own / file) << text;
    }
    const std::string message = error_of([&] { dds::check(dds::KeyFiles(own)); });
    std::ofstream(own / file) << before;
    EXPECT_THAT(message, StartsWith((own / file).string() + ": "));
    return message;
  };
  for (const char* file : {"identity_ca.cert.pem", "cert.pem", "key.pem", "permissions_ca.cert.pem",
                           "governance.p7s", "permissions.p7s"}) {
    EXPECT_THAT(complaint(file, ""), HasSubstr("cannot be read, expected a"));
    EXPECT_THAT(complaint(file, "junk"), HasSubstr("expected a"));
  }
  const auto theirs = [&](const char* file) { return text_of(other / file); };
  EXPECT_THAT(complaint("cert.pem", theirs("cert.pem")),
              HasSubstr("expected a certificate of identity_ca.cert.pem, got: "));
  EXPECT_THAT(complaint("key.pem", text_of(beside / "key.pem")),
              EndsWith("expected the key of cert.pem"));
  for (const char* file : {"governance.p7s", "permissions.p7s"}) {
    EXPECT_THAT(complaint(file, theirs(file)),
                EndsWith("expected a text that permissions_ca.cert.pem signed, unchanged"));
    std::string changed = text_of(own / file);
    changed.replace(changed.find("230"), 3, "231");
    EXPECT_THAT(complaint(file, changed), HasSubstr("unchanged"));
  }
  EXPECT_NO_THROW(dds::check(dds::KeyFiles(own)));
  EXPECT_THAT(error_of([] { dds::Node::open({.keys = "/nowhere"}); }),
              StartsWith("/nowhere/identity_ca.cert.pem: cannot be read"));
}

TEST_F(Keys, WhatIsOutOfDateIsSaidSo) {
  const auto now = std::chrono::system_clock::now();
  const fs::path own =
      make("store", "camera", {.days = 30, .now = now - std::chrono::hours(24 * 31)});
  EXPECT_THAT(error_of([&] { dds::check(dds::KeyFiles(own)); }),
              AllOf(HasSubstr("cert.pem: expected a certificate"), HasSubstr("expired")));
}

TEST_F(Keys, WrongNamesAndTopicsAreRefused) {
  for (const char* name : {"", "/", "a b", "a-b", "../a", "a/", "a//b", "<x>"}) {
    EXPECT_THAT(error_of([&] { make("store", name); }), HasSubstr("expected a name of letters"));
  }
  EXPECT_THAT(error_of([&] { make("store", "a", {.publish = {"rgbd0"}}); }),
              HasSubstr("expected a topic such as /rgbd0/*"));
  EXPECT_THAT(error_of([&] { make("store", "a", {.subscribe = {"/<topic>"}}); }),
              HasSubstr("expected a topic such as /rgbd0/*"));
  EXPECT_FALSE(fs::exists(folder_.path() / "store"));
}

/// Somebody who says their own name on a topic, and hears others' there.
class Party {
 public:
  explicit Party(const std::string& keys, std::uint8_t name)
      : node_(dds::Node::open({.domain = dds::default_domain(), .keys = keys})),
        to_(node_, topic, Delivery::newest),
        from_(node_),
        message_{0, 1, 0, 0, name} {
    from_.add(topic, Delivery::newest);
  }
  void say() { to_.send(message_); }
  void listen() {
    dds::Received received;
    while (from_.take(received, milliseconds(1))) ++heard[received.bytes.at(4)];
  }

  std::map<std::uint8_t, int> heard;

 private:
  inline static const dds::Topic topic{"/words", "test::Word_"};
  std::shared_ptr<dds::Node> node_;
  dds::Publication to_;
  dds::Subscriptions from_;
  std::vector<std::uint8_t> message_;
};

TEST_F(Keys, OnlyThoseWithKeysOfOneAuthorityMeet) {
  const Ros2Domain domain;
  Party camera(make("store", "camera"), 1);
  Party user(make("store", "user"), 2);
  Party stranger(make("other", "user"), 3);
  Party friend_of_stranger(make("other", "friend"), 4);
  Party nobody("", 5);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  // All three circles have met; then some more, so that others could have, too.
  int more = 100;
  while (more > 0 && std::chrono::steady_clock::now() < end) {
    for (Party* const party : {&camera, &user, &stranger, &friend_of_stranger, &nobody}) {
      party->say();
      party->listen();
    }
    const bool have_met = user.heard.contains(1) && camera.heard.contains(2) &&
                          stranger.heard.contains(4) && friend_of_stranger.heard.contains(3) &&
                          nobody.heard.contains(5);
    if (have_met) --more;
  }
  EXPECT_EQ(more, 0);
  const auto heard = [](const Party& party) {
    std::vector<int> names;
    for (const auto& [name, count] : party.heard) names.push_back(name);
    return names;
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(heard(camera), ElementsAre(1, 2));
  EXPECT_THAT(heard(user), ElementsAre(1, 2));
  EXPECT_THAT(heard(stranger), ElementsAre(3, 4));
  EXPECT_THAT(heard(friend_of_stranger), ElementsAre(3, 4));
  EXPECT_THAT(heard(nobody), ElementsAre(5));
}

TEST_F(Keys, PermissionsSayWhoMaySend) {
  const Ros2Domain domain;
  const auto listener =
      dds::Node::open({.domain = domain.number(),
                       .keys = make("store", "listener",
                                    {.publish = {"/diagnostics"}, .subscribe = {"/rgbd0/*"}})});
  const auto publish = [&](const char* name) {
    dds::Publication(listener, {name, "test::Word_"}, Delivery::newest);
  };
  EXPECT_NO_THROW(publish("/diagnostics"));
  EXPECT_THAT(error_of([&] { publish("/rgbd0/color"); }),
              AllOf(HasSubstr("/rgbd0/color cannot be written: do the permissions in "),
                    HasSubstr("enclaves/listener allow it?")));
  dds::Subscriptions subscriptions(listener);
  EXPECT_NO_THROW(subscriptions.add({"/rgbd0/color", "test::Word_"}, Delivery::newest));
  EXPECT_THAT(error_of([&] {
                subscriptions.add({"/diagnostics", "test::Word_"}, Delivery::newest);
              }),
              HasSubstr("/diagnostics cannot be read: do the permissions in "));
}

}  // namespace
}  // namespace diminish
