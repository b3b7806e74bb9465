#include "setup/keys/authority.h"

#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include "diminish/error.h"

namespace diminish {
namespace {

using dds::Bio;
using dds::Certificate;
using dds::Freed;
using dds::Key;
using Number = std::unique_ptr<BIGNUM, Freed<BN_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;

constexpr int serial_bits = 127;
constexpr long version_3 = 2;

void expect(bool is_done) {
  if (!is_done) throw Error("OpenSSL cannot make keys on this machine");
}

void set_time(ASN1_TIME* field, std::chrono::system_clock::time_point time) {
  expect(ASN1_TIME_set(field, std::chrono::system_clock::to_time_t(time)) != nullptr);
}

void add_extension(X509* to, int kind, const char* value) {
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, kind, value));
  expect(extension && X509_add_ext(to, extension.get(), -1) == 1);
}

/// issuer: null: itself.
Certificate make_certificate(const std::string& name, const Key& key, const Validity& validity,
                             const Authority* issuer, const Key& issuer_key) {
  Certificate made(X509_new());
  expect(made && X509_set_version(made.get(), version_3) == 1);
  const Number serial(BN_new());
  expect(serial && BN_rand(serial.get(), serial_bits, BN_RAND_TOP_ANY, BN_RAND_BOTTOM_ANY) == 1);
  expect(BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(made.get())) != nullptr);
  set_time(X509_getm_notBefore(made.get()), validity.from);
  set_time(X509_getm_notAfter(made.get()), validity.until);
  X509_NAME* const subject = X509_get_subject_name(made.get());
  expect(X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1,
                                    0) == 1);
  X509* const by = issuer ? issuer->certificate.get() : made.get();
  expect(X509_set_issuer_name(made.get(), X509_get_subject_name(by)) == 1);
  expect(X509_set_pubkey(made.get(), key.get()) == 1);
  add_extension(made.get(), NID_basic_constraints,
                issuer ? "critical,CA:FALSE" : "critical,CA:TRUE,pathlen:1");
  expect(X509_sign(made.get(), issuer_key.get(), EVP_sha256()) > 0);
  return made;
}

std::string text_of(const Bio& memory) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  expect(size > 0);
  return {data, static_cast<std::size_t>(size)};
}

Bio memory() {
  Bio made(BIO_new(BIO_s_mem()));
  expect(made != nullptr);
  return made;
}

}  // namespace

Key make_key() {
  Key key(EVP_EC_gen("P-256"));
  expect(key != nullptr);
  return key;
}

Authority make_authority(const std::string& name, const Validity& validity) {
  Authority made;
  made.key = make_key();
  made.certificate = make_certificate(name, made.key, validity, nullptr, made.key);
  return made;
}

Authority read_authority(const std::filesystem::path& certificate,
                         const std::filesystem::path& key) {
  Authority authority{dds::read_certificate(certificate), dds::read_private_key(key)};
  if (X509_check_private_key(authority.certificate.get(), authority.key.get()) != 1) {
    throw Error(Error::input,
                key.string() + ": expected the key of " + certificate.filename().string());
  }
  return authority;
}

Certificate certify(const Authority& authority, const std::string& name, const Key& key,
                    const Validity& validity) {
  return make_certificate(name, key, validity, &authority, authority.key);
}

std::string as_pem(const Certificate& certificate) {
  const Bio to = memory();
  expect(PEM_write_bio_X509(to.get(), certificate.get()) == 1);
  return text_of(to);
}

std::string as_pem(const Key& key) {
  const Bio to = memory();
  expect(PEM_write_bio_PKCS8PrivateKey(to.get(), key.get(), nullptr, nullptr, 0, nullptr,
                                       nullptr) == 1);
  return text_of(to);
}

std::string sign(const Authority& authority, const std::string& text) {
  const Bio from(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  expect(from != nullptr);
  constexpr int flags = PKCS7_TEXT | PKCS7_DETACHED;
  const dds::Signed made(PKCS7_sign(authority.certificate.get(), authority.key.get(), nullptr,
                                    from.get(), flags | PKCS7_STREAM));
  expect(made != nullptr);
  const Bio to = memory();
  expect(SMIME_write_PKCS7(to.get(), made.get(), from.get(), flags | PKCS7_STREAM) == 1);
  return text_of(to);
}

}  // namespace diminish
