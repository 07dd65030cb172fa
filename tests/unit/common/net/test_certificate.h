// SPDX-License-Identifier: Apache-2.0
// Certificates that a test makes for itself: an authority, and servers it vouches for.
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <openssl/x509v3.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "common/net/tls.h"

namespace farfield::test {

template <auto kFree>
struct OpenSslDeleter {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using KeyPointer = std::unique_ptr<EVP_PKEY, OpenSslDeleter<EVP_PKEY_free>>;
using CertificatePointer = std::unique_ptr<X509, OpenSslDeleter<X509_free>>;

struct Certified {
  CertificatePointer certificate;
  KeyPointer key;
};

/// `names`: as OpenSSL writes them, "DNS:localhost,IP:127.0.0.1"; empty: an authority. `issuer`: null: itself.
inline Certified make_certificate(const std::string& names, const Certified* issuer, long valid_seconds = 3600) {
  Certified made{CertificatePointer(X509_new()), KeyPointer(EVP_EC_gen("P-256"))};
  X509* const x = made.certificate.get();
  static long serial = 1;
  X509_set_version(x, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(x), ++serial);
  X509_gmtime_adj(X509_getm_notBefore(x), -7200);
  X509_gmtime_adj(X509_getm_notAfter(x), valid_seconds);
  X509_set_pubkey(x, made.key.get());
  const std::string subject = names.empty() ? "test authority " + std::to_string(serial) : "test server";
  X509_NAME_add_entry_by_txt(X509_get_subject_name(x), "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>(subject.c_str()), -1, -1, 0);
  X509_set_issuer_name(x, X509_get_subject_name(issuer ? issuer->certificate.get() : x));
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer ? issuer->certificate.get() : x, x, nullptr, nullptr, 0);
  const auto extend = [&](int which, const std::string& value) {
    std::unique_ptr<X509_EXTENSION, OpenSslDeleter<X509_EXTENSION_free>> extension(X509V3_EXT_conf_nid(nullptr, &context, which, value.c_str()));
    X509_add_ext(x, extension.get(), -1);
  };
  if (names.empty()) {
    extend(NID_basic_constraints, "critical,CA:TRUE");
    extend(NID_key_usage, "critical,keyCertSign");
  } else {
    extend(NID_subject_alt_name, names);
  }
  X509_sign(x, issuer ? issuer->key.get() : made.key.get(), EVP_sha256());
  return made;
}

/// A folder with ca.pem, cert.pem and key.pem, gone with the object.
class CertificateFolder {
 public:
  explicit CertificateFolder(const std::string& names = "DNS:localhost,IP:127.0.0.1", long valid_seconds = 3600) : authority_(make_certificate("", nullptr)) {
    std::string pattern = (std::filesystem::temp_directory_path() / "farfield-tls-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    write_certificate(ca(), authority_.certificate.get());
    renew(names, valid_seconds);
  }
  CertificateFolder(const CertificateFolder&) = delete;
  CertificateFolder& operator=(const CertificateFolder&) = delete;
  ~CertificateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Another certificate of the same authority in the same place.
  void renew(const std::string& names, long valid_seconds = 3600) {
    const Certified server = make_certificate(names, &authority_, valid_seconds);
    write_certificate(files().certificate, server.certificate.get());
    std::FILE* const file = std::fopen(files().key.c_str(), "w");
    PEM_write_PrivateKey(file, server.key.get(), nullptr, nullptr, 0, nullptr, nullptr);
    std::fclose(file);
  }
  TlsFiles files() const { return {folder_ / "cert.pem", folder_ / "key.pem"}; }
  std::filesystem::path ca() const { return folder_ / "ca.pem"; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  static void write_certificate(const std::filesystem::path& path, X509* certificate) {
    std::FILE* const file = std::fopen(path.c_str(), "w");
    PEM_write_X509(file, certificate);
    std::fclose(file);
  }
  Certified authority_;
  std::filesystem::path folder_;
};

}  // namespace farfield::test
