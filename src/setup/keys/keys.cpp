#include "setup/keys/keys.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/text.h"
#include "dds/key_files.h"
#include "diminish/error.h"
#include "setup/keys/authority.h"
#include "setup/keys/policy.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

/// Machines' clocks differ.
constexpr std::chrono::hours before_now(24);

/// As ROS 2 names enclaves: "/lab/camera_host".
std::string enclave_of(const std::string& name) {
  const std::string enclave = name.starts_with('/') ? name : "/" + name;
  bool is_good = enclave.size() > 1 && enclave.size() <= 60 && !enclave.ends_with('/') &&
                 enclave.find("//") == std::string::npos;
  for (const char c : enclave) {
    is_good &= c == '/' || c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0;
  }
  if (!is_good) {
    throw Error("expected a name of letters, digits and _, such as camera_host, got '" +
                printable(name) + "'");
  }
  return enclave;
}

void expect_topics(const std::vector<std::string>& topics) {
  for (const std::string& topic : topics) {
    bool is_good = topic == "*" || topic.starts_with('/');
    for (const char c : topic) {
      is_good &= c == '/' || c == '_' || c == '*' || c == '?' ||
                 std::isalnum(static_cast<unsigned char>(c)) != 0;
    }
    if (!is_good) {
      throw Error("expected a topic such as /rgbd0/* or *, got '" + printable(topic) + "'");
    }
  }
}

void make_folder(const fs::path& folder, fs::perms permissions) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) fs::permissions(folder, permissions, error);
  if (error) throw Error(Error::io, folder.string() + ": cannot be made");
}

/// Nobody else can read it, from its first byte on; what is there is not replaced.
void write_private(const fs::path& file, const std::string& text) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  bool is_done = descriptor >= 0;
  is_done =
      is_done && write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  is_done = is_done && fsync(descriptor) == 0;
  if (descriptor >= 0) close(descriptor);
  if (!is_done) throw Error(Error::io, file.string() + ": cannot be written");
}

void link(const char* to, const fs::path& name) {
  std::error_code error;
  fs::create_symlink(to, name, error);
  if (error) throw Error(Error::io, name.string() + ": cannot be written");
}

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  std::ifstream stream(file, std::ios::binary);
  if (!(text << stream.rdbuf())) throw Error(Error::io, file.string() + ": cannot be read");
  return text.str();
}

/// The files of SROS2's keystore that belong to nobody in particular.
class Keystore {
 public:
  explicit Keystore(const fs::path& folder)
      : folder_(folder), public_(folder / "public"), private_(folder / "private") {}

  bool exists() const {
    std::error_code ignored;
    return fs::exists(private_, ignored) || fs::exists(public_, ignored);
  }
  fs::path certificate(const char* kind) const {
    return public_ / fmt::format("{}_ca.cert.pem", kind);
  }
  Authority authority(const char* kind) const {
    return read_authority(certificate(kind), private_ / fmt::format("{}_ca.key.pem", kind));
  }
  fs::path governance() const { return folder_ / "enclaves/governance.p7s"; }
  fs::path enclave(const std::string& name) const { return folder_ / "enclaves" / name.substr(1); }

  /// One authority for both.
  void make(const Validity& validity) const {
    make_folder(public_, fs::perms(0755));
    make_folder(private_, fs::perms(0700));
    make_folder(folder_ / "enclaves", fs::perms(0755));
    const Authority made = make_authority("diminish", validity);
    write_private(private_ / "ca.key.pem", as_pem(made.key));
    write_file(public_ / "ca.cert.pem", as_pem(made.certificate));
    for (const char* kind : {"identity", "permissions"}) {
      link("ca.key.pem", private_ / fmt::format("{}_ca.key.pem", kind));
      link("ca.cert.pem", certificate(kind));
    }
    write_file(folder_ / "enclaves/governance.xml", governance_xml());
    write_file(governance(), sign(made, governance_xml()));
  }

 private:
  fs::path folder_, public_, private_;
};

}  // namespace

KeysMade make_keys(const fs::path& folder, const KeysRequest& request) {
  expect_topics(request.publish);
  expect_topics(request.subscribe);
  const Keystore store(folder);
  std::vector<std::string> enclaves;
  for (const std::string& name : request.names) {
    enclaves.push_back(enclave_of(name));
    const fs::path key = dds::KeyFiles(store.enclave(enclaves.back())).private_key;
    std::error_code ignored;
    if (fs::exists(key, ignored)) {
      throw Error(key.string() + ": expected a name that has no keys yet");
    }
  }
  const Validity validity{request.now - before_now,
                          request.now + std::chrono::hours(24) * request.days};
  KeysMade made;
  made.is_new_authority = !store.exists();
  if (made.is_new_authority) store.make(validity);
  const Authority identity = store.authority("identity");
  const Authority permissions = store.authority("permissions");
  const bool may_all = request.publish.empty() && request.subscribe.empty();
  const std::vector<std::string> all = {"*"};
  for (const std::string& enclave : enclaves) {
    const fs::path own = store.enclave(enclave);
    make_folder(own, fs::perms(0700));
    const dds::KeyFiles files(own);
    // Copies, not links: the folder is what a machine gets.
    write_file(files.identity_authority, text_of(store.certificate("identity")));
    write_file(files.permissions_authority, text_of(store.certificate("permissions")));
    write_file(files.governance, text_of(store.governance()));
    const std::string xml =
        permissions_xml({enclave, may_all ? all : request.publish,
                         may_all ? all : request.subscribe, validity.from, validity.until});
    write_file(own / "permissions.xml", xml);
    write_file(files.permissions, sign(permissions, xml));
    const dds::Key key = make_key();
    write_file(files.certificate, as_pem(certify(identity, enclave, key, validity)));
    write_private(files.private_key, as_pem(key));
    made.folders.push_back(own);
  }
  return made;
}

}  // namespace diminish
