#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <filesystem>
#include <memory>

namespace diminish::dds {

// OpenSSL's objects, which free themselves.

template <auto free>
struct Freed {
  template <class Object>
  void operator()(Object* object) const {
    free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Signed = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

/// Each throws Error that names the file and what was expected.
Bio open_file(const std::filesystem::path& file, const char* expected);
Certificate read_certificate(const std::filesystem::path& file);
/// Of a key without a passphrase.
Key read_private_key(const std::filesystem::path& file);

}  // namespace diminish::dds
