#include "dds/key_files.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509_vfy.h>

#include "dds/openssl.h"
#include "diminish/error.h"

namespace diminish::dds {
namespace {

using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& expected) {
  ERR_clear_error();
  throw Error(Error::input, file.string() + ": expected " + expected);
}

/// Never asks anybody.
int no_passphrase(char*, int, int, void*) {
  return -1;
}

void expect_signed_by(const Certificate& certificate, const std::filesystem::path& file,
                      const Certificate& authority, const std::filesystem::path& authority_file) {
  const Store store(X509_STORE_new());
  const StoreContext context(X509_STORE_CTX_new());
  if (!store || !context || X509_STORE_add_cert(store.get(), authority.get()) != 1 ||
      X509_STORE_CTX_init(context.get(), store.get(), certificate.get(), nullptr) != 1) {
    throw Error(file.string() + ": cannot be checked");
  }
  if (X509_verify_cert(context.get()) == 1) return;
  fail(file, "a certificate of " + authority_file.filename().string() + ", got: " +
                 X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get())));
}

/// An S/MIME message that the authority itself signed, as the plugins want it.
void expect_signed_text(const std::filesystem::path& file, const Certificate& authority,
                        const std::filesystem::path& authority_file) {
  const Bio stream = open_file(file, "a text signed as S/MIME");
  BIO* text = nullptr;
  const Signed message(SMIME_read_PKCS7(stream.get(), &text));
  const Bio content(text);
  if (!message) fail(file, "a text signed as S/MIME");
  STACK_OF(X509)* const signers = sk_X509_new_null();
  sk_X509_push(signers, authority.get());
  const Bio ignored(BIO_new(BIO_s_null()));
  const int result = PKCS7_verify(message.get(), signers, nullptr, content.get(), ignored.get(),
                                  PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN);
  sk_X509_free(signers);
  if (result != 1) {
    fail(file, "a text that " + authority_file.filename().string() + " signed, unchanged");
  }
}

}  // namespace

KeyFiles::KeyFiles(const std::filesystem::path& folder)
    : identity_authority(folder / "identity_ca.cert.pem"),
      certificate(folder / "cert.pem"),
      private_key(folder / "key.pem"),
      permissions_authority(folder / "permissions_ca.cert.pem"),
      governance(folder / "governance.p7s"),
      permissions(folder / "permissions.p7s") {}

Bio open_file(const std::filesystem::path& file, const char* expected) {
  std::error_code ignored;
  Bio bio(std::filesystem::is_regular_file(file, ignored) ? BIO_new_file(file.c_str(), "rb")
                                                          : nullptr);
  if (bio) return bio;
  ERR_clear_error();
  throw Error(Error::io, file.string() + ": cannot be read, expected " + expected);
}

Certificate read_certificate(const std::filesystem::path& file) {
  constexpr const char* expected = "a certificate (PEM)";
  const Bio bio = open_file(file, expected);
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, no_passphrase, nullptr));
  if (!certificate) fail(file, expected);
  return certificate;
}

Key read_private_key(const std::filesystem::path& file) {
  constexpr const char* expected = "a private key without a passphrase (PEM)";
  const Bio bio = open_file(file, expected);
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, nullptr));
  if (!key) fail(file, expected);
  return key;
}

void check(const KeyFiles& files) {
  const Certificate authority = read_certificate(files.identity_authority);
  const Certificate own = read_certificate(files.certificate);
  expect_signed_by(own, files.certificate, authority, files.identity_authority);
  const Key key = read_private_key(files.private_key);
  if (X509_check_private_key(own.get(), key.get()) != 1) {
    fail(files.private_key, "the key of " + files.certificate.filename().string());
  }
  const Certificate permitting = read_certificate(files.permissions_authority);
  expect_signed_text(files.governance, permitting, files.permissions_authority);
  expect_signed_text(files.permissions, permitting, files.permissions_authority);
}

}  // namespace diminish::dds
